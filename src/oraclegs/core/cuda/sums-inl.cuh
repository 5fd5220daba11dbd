#pragma once
// Sums in an order that depends on the size of the work only: no atomic ever adds a float, so that each run gives the
// same bits.

#include "oraclegs/core/cuda/launch.h"

namespace oraclegs::cuda {

inline constexpr int kSumThreads = 256;  ///< threads of every block that sums
inline constexpr int kSumWarps = kSumThreads / kWarp;

/// The sum over a block of kSumThreads threads, in every thread; `shared` has kSumWarps entries. All threads call it.
__device__ inline double BlockSum(double value, int thread, double* shared) {
  value = WarpSum(value);
  if (thread % kWarp == 0) shared[thread / kWarp] = value;
  __syncthreads();
  double sum = 0;
  for (int warp = 0; warp < kSumWarps; ++warp) sum += shared[warp];
  __syncthreads();  // the next sum overwrites it
  return sum;
}

}  // namespace oraclegs::cuda
