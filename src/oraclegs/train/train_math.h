#pragma once
// The mathematics of training one Gaussian, or one number, for host and device. Vectorized code of the CPU is in its
// own files.

#include <cmath>
#include <cstdint>

#include "oraclegs/core/device_macros.h"
#include "oraclegs/core/rng.h"
#include "oraclegs/train/constants.h"

namespace oraclegs {

ORACLEGS_HD inline double OpacityOf(float logit) { return 1 / (1 + std::exp(-static_cast<double>(logit))); }
ORACLEGS_HD inline double LogitOf(double opacity) { return std::log(opacity) - std::log1p(-opacity); }

/// New opacity and scale ratio s_new / s of a source of opacity o shared by n Gaussians
/// (docs/method.md#mcmc-relocation).
struct Relocated {
  double opacity = 0;            ///< clamped to [0.005, 1 - 2^-23]
  double opacity_unclamped = 0;  ///< the opacity that the scale was computed from
  double scale_ratio = 0;
};

/// Solves for the opacity and scale of n copies in double: the sum alternates, and for o -> 1 and large n float32 would
/// lose several digits. n is in 1 .. kMaxCopies; choose[k] is C(n, k).
ORACLEGS_HD inline Relocated RelocateBy(double opacity, int n, const double* choose) {
  Relocated r;
  r.opacity_unclamped = -std::expm1(std::log1p(-opacity) / n);
  double sum = 0, power = 1;
  for (int k = 0; k < n; ++k) {
    power *= r.opacity_unclamped;
    sum += choose[k + 1] * (k % 2 ? -power : power) / std::sqrt(k + 1.0);
  }
  // For opacity 0 the ratio is 0/0, whose limit is 1.
  r.scale_ratio = opacity > 0 ? opacity / sum : 1;
  r.opacity = r.opacity_unclamped < kMinOpacity   ? kMinOpacity
              : r.opacity_unclamped > kMaxOpacity ? kMaxOpacity
                                                  : r.opacity_unclamped;
  return r;
}

/// Uniform number in [0, 1), 53 bits, of this counter; for weighted draws.
ORACLEGS_HD inline double DrawUniform(uint64_t seed, RandomStream stream, uint64_t counter) {
  return Philox::Draw(seed, static_cast<uint64_t>(stream), counter).Uniform();
}

/// Number of Gaussians to add to n: 5 %, to at most `max` in all.
inline int64_t GrowthOf(int64_t n, int64_t max) {
  const int64_t grown = n + n / 20 < max ? n + n / 20 : max;
  return grown > n ? grown - n : 0;
}

/// The logarithm of the largest scale that a Gaussian of this center may have; see outliers.h. centers: [count,3].
ORACLEGS_HD inline float LogScaleCap(const float* mean, const float* centers, int count, float log_share) {
  float nearest = 3.4e38f;
  for (int c = 0; c < count; ++c) {
    const float dx = mean[0] - centers[3 * c], dy = mean[1] - centers[3 * c + 1], dz = mean[2] - centers[3 * c + 2];
    const float squared = dx * dx + dy * dy + dz * dz;
    if (squared < nearest) nearest = squared;
  }
  constexpr float kMinSquared = 1e-12f;  // a Gaussian in a camera's center keeps some size
  return log_share + 0.5f * std::log(nearest > kMinSquared ? nearest : kMinSquared);
}

/// Votes of the views about one Gaussian's center; see outliers.h.
struct FloaterVotes {
  int before = 0, agree = 0;
  bool beside = false;  ///< beside a silhouette in some view: no number of other views puts a surface there

  /// Adds a vote. ratio: z times the inverse depth under the center; 1 on the surface, less before it, 0 where the
  /// pixel is empty.
  ORACLEGS_HD inline void Add(double ratio) {
    beside = beside || ratio == 0;
    before += ratio * kFloaterRatio < 1;
    agree += (ratio < 1 ? 1 - ratio : ratio - 1) < kAgreementRatio;
  }
  ORACLEGS_HD inline bool IsFloater() const { return beside || (before > 0 && before >= agree); }
};

/// One entry of an exposure map with its moments and its photo's step number t.
struct ExposureEntry {
  float value, m, v;
};
ORACLEGS_HD inline void StepExposure(double gradient, double t, double learning_rate, ExposureEntry* e) {
  const double correction1 = 1 - std::pow(kAdamBeta1, t), correction2 = 1 - std::pow(kAdamBeta2, t);
  e->m = static_cast<float>(kAdamBeta1 * static_cast<double>(e->m) + (1 - kAdamBeta1) * gradient);
  e->v = static_cast<float>(kAdamBeta2 * static_cast<double>(e->v) + (1 - kAdamBeta2) * gradient * gradient);
  const double step =
      static_cast<double>(e->m) / correction1 / (std::sqrt(static_cast<double>(e->v) / correction2) + kExposureEpsilon);
  e->value = static_cast<float>(static_cast<double>(e->value) - learning_rate * step);
}

}  // namespace oraclegs
