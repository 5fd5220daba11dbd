#pragma once
// Hand-made splats for the kernels' tests.

#include <cmath>

#include "oraclegs/core/rng.h"
#include "oraclegs/render/cpu/kernels.h"

namespace oraclegs {

/// A splat of covariance [xx xy; xy yy] px^2 around (mx, my).
inline cpu::Splat MakeSplat(double mx, double my, const double (&cov)[3], double opacity, double depth = 1) {
  const double det = cov[0] * cov[2] - cov[1] * cov[1], log2e = 1.442695040888963;
  cpu::Splat s{};
  s.mx = static_cast<float>(mx), s.my = static_cast<float>(my);
  s.qxx = static_cast<float>(-0.5 * log2e * cov[2] / det);
  s.qxy = static_cast<float>(log2e * cov[1] / det);
  s.qyy = static_cast<float>(-0.5 * log2e * cov[0] / det);
  s.log2_opacity = static_cast<float>(std::log2(opacity));
  s.r = 0.9f, s.g = 0.5f, s.b = 0.1f;
  s.inv_z = static_cast<float>(1 / depth);
  s.depth = static_cast<float>(depth);
  s.opacity = static_cast<float>(opacity);
  return s;
}

/// A random ellipse, from dots to needles, centred in or around an image of this size.
inline cpu::Splat RandomSplat(Rng* rng, double width, double height) {
  const double angle = rng->Uniform(0, 3.14159), c = std::cos(angle), s = std::sin(angle);
  const double a = std::exp(rng->Uniform(-1, 7)), b = std::exp(rng->Uniform(-1, 4));
  const double cov[3] = {a * c * c + b * s * s + 0.3, (a - b) * c * s, a * s * s + b * c * c + 0.3};
  return MakeSplat(rng->Uniform(-0.3, 1.3) * width, rng->Uniform(-0.3, 1.3) * height, cov, rng->Uniform(0.005, 1),
                   rng->Uniform(0.3, 9));
}

/// alpha of a splat at a pixel centre, in double, before cap and threshold.
inline double AlphaAt(const cpu::Splat& s, double x, double y) {
  const double dx = x - s.mx, dy = y - s.my;
  return std::exp2(s.log2_opacity + s.qxx * dx * dx + s.qxy * dx * dy + s.qyy * dy * dy);
}

}  // namespace oraclegs
