#pragma once
// The losses of spec/gaussian_core.md 9 again, slowly: double precision, one pixel at a time, as they are written.

#include <algorithm>
#include <cmath>

#include "oraclegs/core/buffer.h"

namespace oraclegs {

struct ReferencePhotometric {
  double l1 = 0, dssim = 0;
  Buffer<float> ssim;  ///< [H,W,3] float64
};

/// render, target [H,W,3], confidence [H,W]; any floating type.
inline ReferencePhotometric ReferenceLoss(const Buffer<float>& render, const Buffer<float>& target, const Buffer<float>& confidence) {
  const Buffer<float> x = render.to(torch::kDouble), y = target.to(torch::kDouble);
  const Buffer<float> u = confidence.to(torch::kDouble);
  const int64_t height = x.size(0), width = x.size(1);
  double window[11], sum = 0;
  for (int i = 0; i < 11; ++i) sum += window[i] = std::exp(-(i - 5) * (i - 5) / (2 * 1.5 * 1.5));
  ReferencePhotometric out;
  out.ssim = torch::zeros({height, width, 3}, torch::kDouble);
  const auto xs = x.accessor<double, 3>(), ys = y.accessor<double, 3>();
  const auto us = u.accessor<double, 2>();
  auto map = out.ssim.accessor<double, 3>();
  for (int64_t r = 0; r < height; ++r) {
    for (int64_t c = 0; c < width; ++c) {
      for (int k = 0; k < 3; ++k) {
        double mx = 0, my = 0, xx = 0, yy = 0, xy = 0;
        for (int64_t i = std::max<int64_t>(0, r - 5); i <= std::min(height - 1, r + 5); ++i) {
          for (int64_t j = std::max<int64_t>(0, c - 5); j <= std::min(width - 1, c + 5); ++j) {
            const double w = window[i - r + 5] * window[j - c + 5] / (sum * sum), a = xs[i][j][k], b = ys[i][j][k];
            mx += w * a, my += w * b, xx += w * a * a, yy += w * b * b, xy += w * a * b;
          }
        }
        map[r][c][k] = (2 * mx * my + 1e-4) * (2 * (xy - mx * my) + 9e-4) /
                       ((mx * mx + my * my + 1e-4) * (xx - mx * mx + yy - my * my + 9e-4));
        out.l1 += std::abs(xs[r][c][k] - ys[r][c][k]) * us[r][c];
        out.dssim += (1 - map[r][c][k]) * us[r][c];
      }
    }
  }
  const double entries = 3.0 * static_cast<double>(height * width);
  out.l1 /= entries;
  out.dssim /= entries;
  return out;
}

}  // namespace oraclegs
