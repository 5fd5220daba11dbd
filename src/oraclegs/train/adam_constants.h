#pragma once
// What every device's Adam is told of a step. Free of libtorch, for device code.

#include "oraclegs/gaussians/gaussian_rows.h"

namespace oraclegs {

/// Learning rates of one step, by parameter group.
struct LearningRates {
  double means = 0;  ///< already times extent and schedule
  double log_scales = 0.005;
  double quats = 0.001;
  double opacity_logits = 0.05;
  double sh0 = 0.0025;
  double sh_rest = 0.0025 / 20;

  void ScaleAll(double factor) {
    for (double* rate : {&means, &log_scales, &quats, &opacity_logits, &sh0, &sh_rest}) *rate *= factor;
  }
};

/// What of one step is the same for all Gaussians. Learning rates are times 1 / (1 - beta1^t).
struct AdamConstants {
  float correction2_root;  ///< 1 / sqrt(1 - beta2^t)
  float means, log_scales, quats, opacity_logits;
  float sh[kShFloats];
  int sh_active;  ///< floats of a row of sh that are trained
};

}  // namespace oraclegs
