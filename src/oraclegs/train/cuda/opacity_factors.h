#pragma once
// The draws of train/opacity_factors.h on a GPU; they differ by rounding only.

#include <cuda_runtime.h>

#include <cstdint>

namespace oraclegs::cuda {

struct OpacityFactorsInput {
  uint64_t seed = 0;
  int64_t iteration = 0;
  double drop = 0, noise = 0;
  int64_t count = 0;
  float* factors = nullptr;  ///< [count], in device memory
};

/// Queues the draws.
void RunOpacityFactors(const OpacityFactorsInput& in, cudaStream_t stream);

}  // namespace oraclegs::cuda
