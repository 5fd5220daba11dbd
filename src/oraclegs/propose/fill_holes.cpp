#include "oraclegs/propose/fill_holes.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace oraclegs {
namespace {

constexpr int kRadius = 2;

struct Level {
  int width = 0, height = 0;
  std::vector<float> color, weight;  // colors are not multiplied by their weight
};

/// Level of half the size: each pixel is the weighted mean of the four below it, with their summed weight, at most 1.
Level Pushed(const Level& fine, int channels) {
  Level coarse;
  coarse.width = (fine.width + 1) / 2, coarse.height = (fine.height + 1) / 2;
  const size_t pixels = static_cast<size_t>(coarse.width) * coarse.height;
  coarse.color.assign(pixels * channels, 0), coarse.weight.assign(pixels, 0);
  for (int y = 0; y < fine.height; ++y) {
    for (int x = 0; x < fine.width; ++x) {
      const size_t i = static_cast<size_t>(y) * fine.width + x, j = static_cast<size_t>(y / 2) * coarse.width + x / 2;
      for (int c = 0; c < channels; ++c)
        coarse.color[j * channels + c] += fine.weight[i] * fine.color[i * channels + c];
      coarse.weight[j] += fine.weight[i];
    }
  }
  for (size_t j = 0; j < pixels; ++j) {
    if (coarse.weight[j] <= 0) continue;
    for (int c = 0; c < channels; ++c) coarse.color[j * channels + c] /= coarse.weight[j];
    coarse.weight[j] = std::min(coarse.weight[j], 1.f);
  }
  return coarse;
}

/// Mixes the coarser level, which has no holes, into the finer one as far as its weights are below 1; linear
/// interpolation between pixel centers.
void Pull(const Level& coarse, int channels, Level* fine) {
  for (int y = 0; y < fine->height; ++y) {
    const float v = (static_cast<float>(y) + 0.5f) / 2 - 0.5f;
    const int y0 = std::max(0, static_cast<int>(v)), y1 = std::min(coarse.height - 1, y0 + 1);
    const float b = std::clamp(v - static_cast<float>(y0), 0.f, 1.f);
    for (int x = 0; x < fine->width; ++x) {
      const size_t i = static_cast<size_t>(y) * fine->width + x;
      const float missing = 1 - std::min(fine->weight[i], 1.f);
      if (missing <= 0) continue;
      const float u = (static_cast<float>(x) + 0.5f) / 2 - 0.5f;
      const int x0 = std::max(0, static_cast<int>(u)), x1 = std::min(coarse.width - 1, x0 + 1);
      const float a = std::clamp(u - static_cast<float>(x0), 0.f, 1.f);
      const auto at = [&](int px, int py, int c) {
        return coarse.color[(static_cast<size_t>(py) * coarse.width + px) * channels + c];
      };
      for (int c = 0; c < channels; ++c) {
        const float pulled =
            (1 - b) * ((1 - a) * at(x0, y0, c) + a * at(x1, y0, c)) + b * ((1 - a) * at(x0, y1, c) + a * at(x1, y1, c));
        float& color = fine->color[i * channels + c];
        color = fine->weight[i] > 0 ? (1 - missing) * color + missing * pulled : pulled;
      }
    }
  }
}

}  // namespace

std::vector<float> FillDepth(int width, int height, const std::vector<uint8_t>& to_fill,
                             std::vector<float>* inv_depth) {
  std::vector<float> rings(to_fill.size(), 0);
  std::vector<size_t> missing, later;
  std::vector<std::pair<size_t, float>> found;
  std::vector<float> around;
  for (size_t i = 0; i < to_fill.size(); ++i) {
    if (to_fill[i] != 0) missing.push_back(i);
  }
  for (int ring = 1; !missing.empty(); ++ring) {
    later.clear(), found.clear();
    for (const size_t i : missing) {
      const int x = static_cast<int>(i % static_cast<size_t>(width)),
                y = static_cast<int>(i / static_cast<size_t>(width));
      around.clear();
      for (int v = std::max(0, y - kRadius); v <= std::min(height - 1, y + kRadius); ++v) {
        for (int u = std::max(0, x - kRadius); u <= std::min(width - 1, x + kRadius); ++u) {
          const float w = (*inv_depth)[static_cast<size_t>(v) * width + u];
          if (w > 0) around.push_back(w);
        }
      }
      if (around.empty()) {
        later.push_back(i);
        continue;
      }
      const auto quartile = around.begin() + static_cast<int64_t>(around.size() / 4);
      std::nth_element(around.begin(), quartile, around.end());
      found.emplace_back(i, *quartile);
    }
    if (found.empty()) break;
    for (const auto& [i, w] : found) (*inv_depth)[i] = w, rings[i] = static_cast<float>(ring * kRadius);
    missing.swap(later);
  }
  for (const size_t i : missing) rings[i] = static_cast<float>(width + height);
  return rings;
}

void PushPull(const std::vector<float>& weight, ImageF* image) {
  if (!std::any_of(weight.begin(), weight.end(), [](float w) { return w > 0; })) return;
  std::vector<Level> levels(1);
  levels[0] = {image->width, image->height, image->data, weight};
  while (levels.back().width > 1 || levels.back().height > 1) levels.push_back(Pushed(levels.back(), image->channels));
  for (size_t l = levels.size() - 1; l > 0; --l) Pull(levels[l], image->channels, &levels[l - 1]);
  image->data = std::move(levels[0].color);
}

}  // namespace oraclegs
