#pragma once
// Gate of a feed-forward layer: a * GELU(g), where one product gives a and g side by side
// (docs/method.md#seva-multi-view-transformer).

#include <cuda_runtime.h>

#include <cstdint>

namespace oraclegs::cuda {

/// Pointers are to bfloat16 bits in device memory.
struct GatedGelu {
  int64_t rows = 0;
  int width = 0;                   ///< width of the result, a multiple of 8
  const uint16_t* both = nullptr;  ///< [rows, 2 width]: values, then gates
  uint16_t* out = nullptr;         ///< [rows, width]
};
/// Queues the work. It computes in float32, with GELU's error function to 2e-7.
void RunGatedGelu(const GatedGelu& in, cudaStream_t stream);

}  // namespace oraclegs::cuda
