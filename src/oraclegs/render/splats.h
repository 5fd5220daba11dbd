#pragma once
// Plain memory that the kernels of every device read and write.

#include <cstdint>

#include "oraclegs/core/device_macros.h"

namespace oraclegs {

/// Raw parameters of n Gaussians, rows as in GaussianRows. On a GPU sh is aligned to 16 bytes.
struct GaussianParameters {
  const float *means, *log_scales, *quats, *opacity_logits, *sh;
  const float* opacity_factors;  ///< null: all are 1. Unused by the backward pass
  int64_t n;
};

/// One Gaussian as the blend loop reads it. With d = pixel - center its falloff is
/// exp2(log2_opacity - (ax dx)^2 - (by (dy + slope dx))^2): the quadratic form of the inverse covariance, written as a
/// sum of squares. It needs no more operations, never exceeds its peak, and keeps its digits on needles, where the
/// three terms of the form itself cancel. log2(e) and the factor 1/2 are inside ax and by.
struct alignas(16) Splat {
  float mx, my;         ///< px, whole image
  float ax, by, slope;  ///< ax^2 = log2(e)/2 / cov_xx, by^2 = log2(e)/2 conic_yy (1/px^2), slope = -cov_xy / cov_xx
  float log2_opacity;
  float depth, unused;
  float r, g, b;
  float inv_z;
};
static_assert(sizeof(Splat) == 48);

/// Tiles that a Gaussian may reach: [x0, x1) x [y0, y1). Empty: not visible.
struct alignas(8) TileRect {
  uint16_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  ORACLEGS_HD int Count() const { return (x1 - x0) * (y1 - y0); }
};

/// dL/d(image plane): [H,W,3], [H,W], [H,W]. A null pointer means zero.
struct UpstreamPlanes {
  const float *image, *alpha, *inv_depth;
};

}  // namespace oraclegs
