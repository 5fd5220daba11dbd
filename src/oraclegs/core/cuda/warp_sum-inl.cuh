#pragma once
// Sums over the lanes of a warp.

#include "oraclegs/core/cuda/launch.h"

namespace oraclegs::cuda {

/// The sum of all lanes' values, in every lane; always added in the same order.
template <class T>
__device__ inline T WarpSum(T value) {
  for (int step = kWarp / 2; step > 0; step /= 2) value += __shfl_xor_sync(kAllLanes, value, step);
  return value;
}

}  // namespace oraclegs::cuda
