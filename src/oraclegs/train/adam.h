#pragma once

#include "oraclegs/gaussians/gaussians.h"

namespace oraclegs {

/// Learning rates of one step, by parameter group.
struct LearningRates {
  double means = 0;  ///< already times extent and schedule
  double log_scales = 0.005;
  double quats = 0.001;
  double opacity_logits = 0.05;
  double sh0 = 0.0025;
  double sh_rest = 0.0025 / 20;
};

/// Adam with beta 0.9, 0.999, epsilon 1e-15 outside the root, one step counter, every Gaussian in every step
/// (spec/gaussian_core.md 8). SH coefficients above the active degree have neither gradient nor moments and are
/// skipped, which is the same.
struct Adam {
  Gaussians m, v;    ///< first and second moments
  int64_t step = 0;  ///< steps taken

  explicit Adam(int64_t n);

  /// params -= lr * m_hat / (sqrt(v_hat) + eps), in place, on all threads.
  void Step(const Gaussians& grads, const LearningRates& rates, int sh_degree, Gaussians* params);
};

}  // namespace oraclegs
