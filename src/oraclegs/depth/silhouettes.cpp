#include "oraclegs/depth/silhouettes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "oraclegs/core/statistics.h"

namespace oraclegs {
namespace {

constexpr float kSameColor = 2.5f / 255;  // per channel: what JPEG and antialiasing leave of one colour
constexpr double kBorderShare = 0.9;      // of the border that must be background
constexpr double kObjectShare = 0.01;     // of the picture that must not: an empty picture has no silhouette
constexpr int kGrowth = 2;                // pixels by which a silhouette may be wrong

using Color = std::array<float, 3>;

Color ColorAt(const LoadedView& photo, size_t pixel) {
  const float* p = photo.rgb.data.data() + 3 * pixel;
  return {p[0], p[1], p[2]};
}

bool Same(const Color& a, const Color& b) {
  for (size_t c = 0; c < 3; ++c) {
    if (std::abs(a[c] - b[c]) > kSameColor) return false;
  }
  return true;
}

std::vector<size_t> BorderPixels(int width, int height) {
  std::vector<size_t> border;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (x == 0 || y == 0 || x == width - 1 || y == height - 1) {
        border.push_back(static_cast<size_t>(y) * width + x);
      }
    }
  }
  return border;
}

/// The background's colour: the median of all photographs' borders.
Color BorderColor(const std::vector<LoadedView>& photos) {
  Color color{};
  for (size_t c = 0; c < 3; ++c) {
    std::vector<float> values;
    for (const LoadedView& photo : photos) {
      for (const size_t i : BorderPixels(photo.rgb.width, photo.rgb.height)) values.push_back(ColorAt(photo, i)[c]);
    }
    color[c] = UpperMedian(&values);
  }
  return color;
}

/// One mask for all photographs is the lens's rim or the photographer's finger, not an object's surroundings.
bool MasksFollowTheScene(const std::vector<LoadedView>& photos) {
  return photos.size() == 1 ||
         std::any_of(photos.begin(), photos.end(), [&](const LoadedView& p) { return p.mask != photos.front().mask; });
}

/// 1 = object; empty when the border is not background.
std::vector<uint8_t> ObjectOf(const LoadedView& photo, const Color& background, bool use_mask) {
  const int width = photo.rgb.width, height = photo.rgb.height;
  const auto is_background = [&](size_t i) {
    return (use_mask && !photo.mask.empty() && photo.mask[i] == 0) || Same(ColorAt(photo, i), background);
  };
  const std::vector<size_t> border = BorderPixels(width, height);
  std::vector<size_t> open;
  std::vector<uint8_t> object(static_cast<size_t>(width) * height, 1);
  const auto take = [&](size_t i) {
    if (object[i] == 0 || !is_background(i)) return;
    object[i] = 0;
    open.push_back(i);
  };
  for (const size_t i : border) take(i);
  if (static_cast<double>(open.size()) < kBorderShare * static_cast<double>(border.size())) return {};
  while (!open.empty()) {
    const size_t i = open.back();
    open.pop_back();
    const int x = static_cast<int>(i % static_cast<size_t>(width)),
              y = static_cast<int>(i / static_cast<size_t>(width));
    if (x > 0) take(i - 1);
    if (x + 1 < width) take(i + 1);
    if (y > 0) take(i - static_cast<size_t>(width));
    if (y + 1 < height) take(i + static_cast<size_t>(width));
  }
  const auto pixels = std::count(object.begin(), object.end(), 1);
  if (static_cast<double>(pixels) < kObjectShare * static_cast<double>(object.size())) return {};
  return object;
}

std::vector<uint8_t> Grown(const std::vector<uint8_t>& object, int width, int height) {
  std::vector<uint8_t> grown(object.size(), 0);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (object[static_cast<size_t>(y) * width + x] == 0) continue;
      for (int v = std::max(0, y - kGrowth); v <= std::min(height - 1, y + kGrowth); ++v) {
        for (int u = std::max(0, x - kGrowth); u <= std::min(width - 1, x + kGrowth); ++u) {
          grown[static_cast<size_t>(v) * width + u] = 1;
        }
      }
    }
  }
  return grown;
}

}  // namespace

Silhouettes::Silhouettes(const std::vector<LoadedView>& photos) {
  if (photos.empty()) return;
  const Color background = BorderColor(photos);
  const bool use_masks = MasksFollowTheScene(photos);
  for (const LoadedView& photo : photos) {
    std::vector<uint8_t> object = ObjectOf(photo, background, use_masks);
    if (object.empty()) {
      *this = Silhouettes({});
      return;
    }
    grown_.push_back(Grown(object, photo.rgb.width, photo.rgb.height));
    object_.push_back(std::move(object));
    sizes_.emplace_back(photo.rgb.width, photo.rgb.height);
  }
}

}  // namespace oraclegs
