#include "oraclegs/validate/smooth.h"

#include <algorithm>
#include <array>

#include "oraclegs/core/error.h"

namespace oraclegs {
namespace {

constexpr int kReach = 2;
constexpr std::array<float, 2 * kReach + 1> kTaps = {1, 4, 6, 4, 1};

/// Smooths `length` values that are `step` apart; `copy` is scratch of that length.
void SmoothLine(float* values, int length, size_t step, std::vector<float>* copy) {
  for (int i = 0; i < length; ++i) (*copy)[static_cast<size_t>(i)] = values[static_cast<size_t>(i) * step];
  for (int i = 0; i < length; ++i) {
    float sum = 0, taps = 0;
    for (int k = std::max(0, i - kReach); k <= std::min(length - 1, i + kReach); ++k) {
      const float tap = kTaps[static_cast<size_t>(k - i + kReach)];
      sum += tap * (*copy)[static_cast<size_t>(k)];
      taps += tap;
    }
    values[static_cast<size_t>(i) * step] = sum / taps;
  }
}

}  // namespace

void Smooth(int width, int height, ConfidenceMap* map) {
  const auto columns = static_cast<size_t>(width), rows = static_cast<size_t>(height);
  if (map->size() != columns * rows) {
    throw ShapeError("Smooth: the map has {} pixels, expected {} x {}", map->size(), width, height);
  }
  std::vector<float> copy(std::max(columns, rows));
  for (size_t y = 0; y < rows; ++y) SmoothLine(map->data() + y * columns, width, 1, &copy);
  for (size_t x = 0; x < columns; ++x) SmoothLine(map->data() + x, height, columns, &copy);
}

}  // namespace oraclegs
