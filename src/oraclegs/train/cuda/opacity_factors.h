#pragma once
// What train/opacity_factors.h draws, drawn on a GPU: the same numbers but for rounding.

#include <cuda_runtime.h>

#include <cstdint>

namespace oraclegs::cuda {

struct OpacityFactorsInput {
  uint64_t seed = 0;
  int64_t iteration = 0;
  double drop = 0, noise = 0;
  int64_t count = 0;
  float* factors = nullptr;  ///< [count], the device's
};

/// Queues the work.
void RunOpacityFactors(const OpacityFactorsInput& in, cudaStream_t stream);

}  // namespace oraclegs::cuda
