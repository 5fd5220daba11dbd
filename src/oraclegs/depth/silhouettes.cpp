#include "oraclegs/depth/silhouettes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "oraclegs/core/statistics.h"

namespace oraclegs {
namespace {

constexpr float kSameBackdropColor = 2.5f / 255;  // per channel: what JPEG and antialiasing leave of one color
constexpr double kBorderShare = 0.9;              // of the border that must be background
constexpr double kObjectShare = 0.01;             // of the image that must not: an empty image has no silhouette
constexpr int kGrowth = 2;                        // pixels by which a silhouette may be wrong

using Color = std::array<float, 3>;

Color ColorAt(const LoadedView& view, size_t pixel) {
  const float* p = view.rgb.data.data() + 3 * pixel;
  return {p[0], p[1], p[2]};
}

bool Same(const Color& a, const Color& b) {
  for (size_t c = 0; c < 3; ++c) {
    if (std::abs(a[c] - b[c]) > kSameBackdropColor) return false;
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

/// Color of the background: the median of all images' borders.
Color BorderColor(const std::vector<LoadedView>& views) {
  Color color{};
  for (size_t c = 0; c < 3; ++c) {
    std::vector<float> values;
    for (const LoadedView& view : views) {
      for (const size_t i : BorderPixels(view.rgb.width, view.rgb.height)) values.push_back(ColorAt(view, i)[c]);
    }
    color[c] = UpperMedian(&values);
  }
  return color;
}

/// Whether masks differ between images. One mask for all images is the lens's rim or the photographer's finger, not an
/// object's surroundings.
bool MasksFollowTheScene(const std::vector<LoadedView>& views) {
  return views.size() == 1 ||
         std::any_of(views.begin(), views.end(), [&](const LoadedView& p) { return p.mask != views.front().mask; });
}

/// Pixels of the object, 1 = object; empty when the border is not background.
std::vector<uint8_t> ObjectOf(const LoadedView& view, const Color& background, bool use_mask) {
  const int width = view.rgb.width, height = view.rgb.height;
  const auto is_background = [&](size_t i) {
    return (use_mask && !view.mask.empty() && view.mask[i] == 0) || Same(ColorAt(view, i), background);
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

Silhouettes::Silhouettes(const std::vector<LoadedView>& views) {
  if (views.empty()) return;
  const Color background = BorderColor(views);
  const bool use_masks = MasksFollowTheScene(views);
  for (const LoadedView& view : views) {
    std::vector<uint8_t> object = ObjectOf(view, background, use_masks);
    if (object.empty()) {
      *this = Silhouettes({});
      return;
    }
    grown_.push_back(Grown(object, view.rgb.width, view.rgb.height));
    object_.push_back(std::move(object));
    sizes_.emplace_back(view.rgb.width, view.rgb.height);
  }
}

}  // namespace oraclegs
