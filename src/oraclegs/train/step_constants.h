#pragma once
// Values of one training step that are the same for all Gaussians, on every device.

#include <cstdint>

#include "oraclegs/gaussians/gaussian_rows.h"

namespace oraclegs {

/// Learning rates of one step, by parameter group.
struct LearningRates {
  double means = 0;  ///< includes extent and schedule
  double log_scales = 0.005;
  double quats = 0.001;
  double opacity_logits = 0.05;
  double sh0 = 0.0025;
  double sh_rest = 0.0025 / 20;

  void ScaleAll(double factor) {
    for (double* rate : {&means, &log_scales, &quats, &opacity_logits, &sh0, &sh_rest}) *rate *= factor;
  }
};

/// Storage of the moments of spherical harmonics (docs/method.md#adam).
enum class ShMoments {
  kFull,     ///< first and second moment of each coefficient in float32
  kHalf,     ///< first and second moment in bfloat16, the second rounded at random
  kCompact,  ///< the first in bfloat16, one second moment for all coefficients of a Gaussian
};

/// Rows of the moments of neighboring Gaussians.
struct MomentRows {
  GaussianRows m, v;              ///< sh null unless full
  uint16_t* sh_m = nullptr;       ///< [m,48] bfloat16; null where full
  uint16_t* sh_v_half = nullptr;  ///< [m,48] bfloat16; null unless half
  float* sh_v = nullptr;          ///< [m]; null unless compact

  ORACLEGS_HD bool half() const { return sh_v_half != nullptr; }
  ORACLEGS_HD bool compact() const { return sh_v != nullptr; }
  /// The rows from row i on.
  ORACLEGS_HD MomentRows From(int64_t i) const {
    if (!half() && !compact()) return {m.From(i), v.From(i)};
    uint16_t* const half_from = half() ? sh_v_half + kShFloats * i : nullptr;
    float* const compact_from = compact() ? sh_v + i : nullptr;
    return {m.FromWithoutSh(i), v.FromWithoutSh(i), sh_m + kShFloats * i, half_from, compact_from};
  }
};

/// Constants of one step of Adam. Learning rates include 1 / (1 - beta1^t).
struct AdamConstants {
  float correction2_root;  ///< 1 / sqrt(1 - beta2^t)
  float means, log_scales, quats, opacity_logits;
  float sh[kShFloats];
  int sh_active;   ///< trained floats of a row of sh
  uint32_t noise;  ///< step * kNoiseOfStep, for RoundingNoise
};

/// Weights of the regularizers per entry: their weights in the loss over N (opacity) or 3 N (scale).
struct RegularizerWeights {
  float opacity = 0, scale = 0;
};

/// Regularizer sums over a set of Gaussians.
struct RegularizerSums {
  double opacity = 0, scale = 0;
};

/// Constants of one step's position noise.
struct NoiseConstants {
  uint64_t seed = 0;
  uint32_t iteration = 0;
  float strength = 0;  ///< 5e5 * lr_means
};

/// Constants of one iteration's opacity factors; see opacity_factors.h.
struct OpacityConstants {
  uint64_t seed = 0;
  uint32_t iteration = 0;
  float drop = 0, noise = 0;
};

}  // namespace oraclegs
