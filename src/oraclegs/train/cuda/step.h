#pragma once
// The work on every Gaussian in every iteration, on a GPU: opacity factors, the regularizers' gradients, Adam and the
// noise of 3DGS-MCMC (docs/method.md#adam, #regularizers, #mcmc-noise). The CPU's: train/opacity_factors.h,
// train/adam.h, train/regularizers.h, train/noise.h.

#include <cuda_runtime.h>

#include <cstdint>

#include "oraclegs/train/step_constants.h"

namespace oraclegs::cuda {

struct GaussianBackwardInput;

inline constexpr int kStepBlock = 256;  ///< Gaussians per block of threads

inline int64_t StepBlocks(int64_t gaussians) { return (gaussians + kStepBlock - 1) / kStepBlock; }

/// Input of RunRegularizerSums, all in device memory.
struct RegularizerInput {
  int64_t count = 0;
  GaussianRows params;
  RegularizerSums* sums = nullptr;  ///< [StepBlocks(count)] receives the sums over kStepBlock Gaussians each
};

/// Queues the partial sums of the regularizers' value.
void RunRegularizerSums(const RegularizerInput& in, cudaStream_t stream);

inline constexpr int kMaxPartGradients = 2;

/// Parameters, moments and constants of a step, all in device memory.
struct StepConstants {
  GaussianRows params;
  MomentRows moments;
  AdamConstants adam;
  RegularizerWeights regularizers;
  NoiseConstants noise;
  bool adds_noise = false;                              ///< after Adam
  int parts = 0;                                        ///< number of part_gradients
  GaussianRows part_gradients[kMaxPartGradients] = {};  ///< added to the view's (train/method_part.h)
};

/// Queues the last stage of the backward pass and the step of each gradient while it is in registers. `step` writes the
/// parameters that `in` reads.
void RunStep(const GaussianBackwardInput& in, const StepConstants& step);

/// Queues the last stage of the backward pass alone, for the screen gradients that it adds up.
void RunWithoutStep(const GaussianBackwardInput& in);

/// Input of the noise of Gaussians [0, count), for iterations that relocate before it.
struct NoiseInput {
  int64_t count = 0;
  GaussianRows params;
  NoiseConstants noise;
};
void RunNoise(const NoiseInput& in, cudaStream_t stream);

/// Input of RunOpacityFactors.
struct OpacityFactorsInput {
  uint64_t seed = 0;
  int64_t iteration = 0;
  double drop = 0, noise = 0;
  int64_t count = 0;
  float* factors = nullptr;  ///< [count], in device memory
};

/// Queues the draws of opacity factors; they differ from the CPU's by rounding only.
void RunOpacityFactors(const OpacityFactorsInput& in, cudaStream_t stream);

}  // namespace oraclegs::cuda
