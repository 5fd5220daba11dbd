#pragma once
// The losses of docs/method.md#losses again, slowly: double precision, one pixel at a time, as they are written.

#include <algorithm>
#include <cmath>

#include "oraclegs/core/buffer.h"

namespace oraclegs {

struct ReferencePhotometric {
  double l1 = 0, dssim = 0;
  Buffer<double> ssim;  ///< [H,W,3]
};

/// render, target [H,W,3], confidence [H,W]; T: float or double.
template <class T>
ReferencePhotometric ReferenceLoss(const Buffer<T>& render, const Buffer<float>& target,
                                   const Buffer<float>& confidence) {
  const int64_t height = render.size(0), width = render.size(1);
  double window[11], sum = 0;
  for (int i = 0; i < 11; ++i) sum += window[i] = std::exp(-(i - 5) * (i - 5) / (2 * 1.5 * 1.5));
  ReferencePhotometric out;
  out.ssim = Buffer<double>::Zeros({height, width, 3});
  for (int64_t r = 0; r < height; ++r) {
    for (int64_t c = 0; c < width; ++c) {
      for (int k = 0; k < 3; ++k) {
        double mx = 0, my = 0, xx = 0, yy = 0, xy = 0;
        for (int64_t i = std::max<int64_t>(0, r - 5); i <= std::min(height - 1, r + 5); ++i) {
          for (int64_t j = std::max<int64_t>(0, c - 5); j <= std::min(width - 1, c + 5); ++j) {
            const int64_t at = (i * width + j) * 3 + k;
            const double w = window[i - r + 5] * window[j - c + 5] / (sum * sum);
            const double a = static_cast<double>(render[at]), b = static_cast<double>(target[at]);
            mx += w * a, my += w * b, xx += w * a * a, yy += w * b * b, xy += w * a * b;
          }
        }
        const int64_t pixel = r * width + c, at = 3 * pixel + k;
        const double u = static_cast<double>(confidence[pixel]);
        out.ssim[at] = (2 * mx * my + 1e-4) * (2 * (xy - mx * my) + 9e-4) /
                       ((mx * mx + my * my + 1e-4) * (xx - mx * mx + yy - my * my + 9e-4));
        out.l1 += std::abs(static_cast<double>(render[at]) - static_cast<double>(target[at])) * u;
        out.dssim += (1 - out.ssim[at]) * u;
      }
    }
  }
  const double entries = 3.0 * static_cast<double>(height * width);
  out.l1 /= entries;
  out.dssim /= entries;
  return out;
}

}  // namespace oraclegs
