#pragma once
// What moves every Gaussian in every iteration: the regularisers' gradients, Adam, the noise of 3DGS-MCMC
// (docs/method.md#adam). The CPU's: train/adam.h, train/mcmc.h.

#include <cuda_runtime.h>

#include <cstdint>

#include "oraclegs/train/step_constants.h"

namespace oraclegs::cuda {

inline constexpr int kStepBlock = 256;  ///< Gaussians of a block of threads

inline int64_t StepBlocks(int64_t gaussians) { return (gaussians + kStepBlock - 1) / kStepBlock; }

struct RegularizerBlock {
  double opacity, scale;  ///< sums over kStepBlock Gaussians
};

/// All memory is the device's.
struct RegularizerInput {
  int64_t count = 0;
  GaussianRows params;
  RegularizerBlock* sums = nullptr;  ///< [StepBlocks(count)] receives the sums
};

/// Queues the sums that the regularisers' value consists of.
void RunRegularizerSums(const RegularizerInput& in, cudaStream_t stream);

/// Per entry: the weights of the loss over N, or 3 N.
struct RegularizerWeights {
  float opacity = 0, scale = 0;
};

struct NoiseConstants {
  uint64_t seed = 0;
  uint32_t iteration = 0;
  float strength = 0;  ///< 5e5 * lr_means
};

/// What a step does with each gradient. The rows begin with Gaussian `first` and are the device's.
struct StepConstants {
  int64_t first = 0;
  GaussianRows params, m, v;
  AdamConstants adam;
  RegularizerWeights regularizers;
  NoiseConstants noise;
  bool adds_noise = false;  ///< after Adam
};

/// Queues the step of Gaussians [step.first, step.first + count); `grads` holds their gradients.
void RunStep(const StepConstants& step, const GaussianRows& grads, int64_t count, cudaStream_t stream);

/// Noise alone, for iterations that relocate before it: Gaussians [0, count).
struct NoiseInput {
  int64_t count = 0;
  GaussianRows params;
  NoiseConstants noise;
};
void RunNoise(const NoiseInput& in, cudaStream_t stream);

}  // namespace oraclegs::cuda
