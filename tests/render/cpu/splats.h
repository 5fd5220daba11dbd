#pragma once
// Hand-made splats for the kernels' tests.

#include <cmath>

#include "oraclegs/core/rng.h"
#include "oraclegs/render/cpu/kernels.h"

namespace oraclegs {

/// A splat of covariance [xx xy; xy yy] px^2 around (mx, my).
inline cpu::LineSplat MakeSplat(double mx, double my, const double (&cov)[3], double opacity, double depth = 1) {
  const double det = cov[0] * cov[2] - cov[1] * cov[1], log2e = 1.442695040888963;
  cpu::LineSplat s{};
  s.mx = static_cast<float>(mx), s.my = static_cast<float>(my);
  s.ax = static_cast<float>(std::sqrt(0.5 * log2e / cov[0]));
  s.by = static_cast<float>(std::sqrt(0.5 * log2e * cov[0] / det));
  s.slope = static_cast<float>(-cov[1] / cov[0]);
  s.log2_opacity = static_cast<float>(std::log2(opacity));
  s.r = 0.9f, s.g = 0.5f, s.b = 0.1f;
  s.inv_z = static_cast<float>(1 / depth);
  s.depth = static_cast<float>(depth);
  return s;
}

/// A random ellipse, from dots to needles, centerd in or around an image of this size.
inline cpu::LineSplat RandomSplat(Rng* rng, double width, double height) {
  const double angle = rng->Uniform(0, 3.14159), c = std::cos(angle), s = std::sin(angle);
  const double a = std::exp(rng->Uniform(-1, 7)), b = std::exp(rng->Uniform(-1, 4));
  const double cov[3] = {a * c * c + b * s * s + 0.3, (a - b) * c * s, a * s * s + b * c * c + 0.3};
  return MakeSplat(rng->Uniform(-0.3, 1.3) * width, rng->Uniform(-0.3, 1.3) * height, cov, rng->Uniform(0.005, 1),
                   rng->Uniform(0.3, 9));
}

/// alpha of a splat at a pixel center, in double, before cap and threshold.
inline double AlphaAt(const cpu::LineSplat& s, double x, double y) {
  const double dx = x - s.mx, p = s.ax * dx, q = s.by * (y - s.my + s.slope * dx);
  return std::exp2(s.log2_opacity - p * p - q * q);
}

}  // namespace oraclegs
