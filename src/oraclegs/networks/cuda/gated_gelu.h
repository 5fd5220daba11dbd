#pragma once
// The gate of a feed-forward layer: a * GELU(g), where a product gives a and g side by side
// (docs/method.md#seva-multi-view-transformer).

#include <cuda_runtime.h>

#include <cstdint>

namespace oraclegs::cuda {

/// bfloat16 as its bits, in the device's memory.
struct GatedGelu {
  int64_t rows = 0;
  int width = 0;                   ///< of the result, a multiple of 8
  const uint16_t* both = nullptr;  ///< [rows, 2 width]: values, then gates
  uint16_t* out = nullptr;         ///< [rows, width]
};
/// Computed in float32, with GELU's error function to 2e-7. Queues the work.
void RunGatedGelu(const GatedGelu& in, cudaStream_t stream);

}  // namespace oraclegs::cuda
