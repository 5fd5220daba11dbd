#include "oraclegs/propose/fill_depth.h"

#include <algorithm>
#include <cstddef>

namespace oraclegs {
namespace {

constexpr int kRadius = 2;

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

}  // namespace oraclegs
