#pragma once

#include <cstdint>

#include "oraclegs/core/device_macros.h"

namespace oraclegs {

inline constexpr int kShFloats = 48;  ///< a Gaussian has 16 coefficients of 3 channels
/// The constant spherical harmonic: without the others, color = 0.5 + kConstantSh * sh.
inline constexpr double kConstantSh = 0.28209479177387814;

/// Rows of neighboring Gaussians, or of anything of their layout (gradients, moments), as plain memory: float32, one
/// row after the other without gaps.
struct GaussianRows {
  float* means;           ///< [m,3]
  float* log_scales;      ///< [m,3]
  float* quats;           ///< [m,4]
  float* opacity_logits;  ///< [m]
  float* sh;              ///< [m,48]

  /// The rows from row i on.
  ORACLEGS_HD GaussianRows From(int64_t i) const {
    return {means + 3 * i, log_scales + 3 * i, quats + 4 * i, opacity_logits + i, sh + kShFloats * i};
  }
  /// The rows from the i-th on, without sh, which becomes null.
  ORACLEGS_HD GaussianRows FromWithoutSh(int64_t i) const {
    return {means + 3 * i, log_scales + 3 * i, quats + 4 * i, opacity_logits + i, nullptr};
  }
};

}  // namespace oraclegs
