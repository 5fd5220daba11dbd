#pragma once
// The noise of 3DGS-MCMC [Kheradmand 2024], which lets Gaussians explore (docs/method.md#mcmc-noise).

#include <cstdint>

#include "oraclegs/gaussians/gaussians.h"
#include "oraclegs/train/step_constants.h"

namespace oraclegs {

/// The noise of one iteration: means += Sigma * (epsilon * gate(opacity) * 5e5 * lr_means), epsilon ~ N(0, I) from
/// (seed, iteration, index of the Gaussian).
struct MeansNoise {
  uint64_t seed = 0;
  int64_t iteration = 0;
  double lr_means = 0;

  NoiseConstants Constants() const;
};

void AddNoise(const MeansNoise& noise, Gaussians* gaussians);
/// Adds the noise to Gaussians [begin, end) alone, on this thread. The partition into blocks changes no bit.
void AddNoiseToBlock(const MeansNoise& noise, int64_t begin, int64_t end, Gaussians* gaussians);
/// Adds the noise for given epsilon [N,3]; for tests.
void AddNoiseFrom(const Buffer<float>& epsilon, double lr_means, Gaussians* gaussians);

}  // namespace oraclegs
