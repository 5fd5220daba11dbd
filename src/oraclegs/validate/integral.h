#pragma once
// Sums of per-pixel values over rectangles (summed-area table).

#include <algorithm>
#include <cstddef>
#include <vector>

namespace oraclegs {

/// A rectangle of pixels, [x0, x1) x [y0, y1).
struct Window {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  /// Square of half side `radius` around a pixel, clipped to the image.
  static Window Around(int x, int y, int radius, int width, int height) {
    return {std::max(0, x - radius), std::max(0, y - radius), std::min(width, x + radius + 1),
            std::min(height, y + radius + 1)};
  }
  double area() const { return static_cast<double>(x1 - x0) * (y1 - y0); }
};

/// Sums over rectangles in constant time.
class Integral {
 public:
  /// value(i) is the value of pixel i, row by row.
  template <class Value>
  Integral(int width, int height, Value&& value)
      : width_(width + 1), sums_(static_cast<size_t>(width + 1) * static_cast<size_t>(height + 1)) {
    for (int y = 0; y < height; ++y) {
      double row = 0;
      for (int x = 0; x < width; ++x) {
        row += static_cast<double>(value(static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)));
        sums_[At(x + 1, y + 1)] = sums_[At(x + 1, y)] + row;
      }
    }
  }
  double Sum(const Window& w) const {
    return sums_[At(w.x1, w.y1)] - sums_[At(w.x0, w.y1)] - sums_[At(w.x1, w.y0)] + sums_[At(w.x0, w.y0)];
  }
  double Mean(const Window& w) const { return Sum(w) / w.area(); }

 private:
  size_t At(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x);
  }
  int width_;
  std::vector<double> sums_;
};

}  // namespace oraclegs
