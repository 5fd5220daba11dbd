#pragma once
// What moves every Gaussian in every iteration, on a GPU: the regularizers' gradients, Adam and the noise of 3DGS-MCMC
// (docs/method.md#adam, #regularizers, #mcmc-noise). The CPU's: train/adam.h, train/regularizers.h, train/noise.h.

#include <cuda_runtime.h>

#include <cstdint>

#include "oraclegs/train/step_constants.h"

namespace oraclegs::cuda {

struct GaussianBackwardInput;

inline constexpr int kStepBlock = 256;  ///< Gaussians of a block of threads

inline int64_t StepBlocks(int64_t gaussians) { return (gaussians + kStepBlock - 1) / kStepBlock; }

/// All memory is the device's.
struct RegularizerInput {
  int64_t count = 0;
  GaussianRows params;
  RegularizerSums* sums = nullptr;  ///< [StepBlocks(count)] receives the sums over kStepBlock Gaussians each
};

/// Queues the sums that the regularizers' value consists of.
void RunRegularizerSums(const RegularizerInput& in, cudaStream_t stream);

/// What a step does with each gradient. All memory is the device's.
struct StepConstants {
  GaussianRows params;
  MomentRows moments;
  AdamConstants adam;
  RegularizerWeights regularizers;
  NoiseConstants noise;
  bool adds_noise = false;  ///< after Adam
};

/// Queues the last stage of the backward pass and the step of each gradient while it is in registers. `step` moves the
/// parameters that `in` reads.
void RunStep(const GaussianBackwardInput& in, const StepConstants& step);

/// Noise alone, for iterations that relocate before it: Gaussians [0, count).
struct NoiseInput {
  int64_t count = 0;
  GaussianRows params;
  NoiseConstants noise;
};
void RunNoise(const NoiseInput& in, cudaStream_t stream);

}  // namespace oraclegs::cuda
