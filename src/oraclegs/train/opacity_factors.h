#pragma once
// Random opacity factors against co-adaptation: with few photos, groups of Gaussians learn to look right together from
// the training views only. Each iteration draws a factor of every Gaussian's opacity, so that none can rely on its
// neighbors.

#include <cstdint>

#include "oraclegs/core/buffer.h"

namespace oraclegs {

/// The factors of one iteration; where both numbers leave all factors at 1 they need not be drawn (IsActive).
struct OpacityPerturbation {
  uint64_t seed = 0;
  int64_t iteration = 0;
  /// Probability in [0,1) that a Gaussian is left out; the others are multiplied by 1 / (1 - drop), so that the
  /// expected opacity stays [Park 2025].
  double drop = 0;
  /// Standard deviation of multiplicative noise, max(0, 1 + noise * N(0,1)) [Chen 2025].
  double noise = 0;

  bool IsActive() const { return drop > 0 || noise > 0; }
};

/// DropGaussian's schedule: the probability grows linearly to `dropout` at the end of the run. 0 in the last iteration,
/// whose loss is that of the final model.
double DropProbability(double dropout, int64_t iteration, int64_t iterations);

/// Writes the factors of Gaussians 0 .. N-1 into `factors` [N]. Each is a pure function of (seed, iteration, index).
void DrawOpacityFactors(const OpacityPerturbation& perturbation, const Buffer<float>& factors);

}  // namespace oraclegs
