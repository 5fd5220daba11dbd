#pragma once
// Sums in an order that depends on the size of the work only: no atomic ever adds a float, so a run gives the same bits
// each time.

namespace oraclegs::cuda {

inline constexpr int kSumThreads = 256;  ///< of every block that sums

/// The sum over a block of kSumThreads threads, in thread 0; `shared` has kSumThreads entries. All threads call it.
__device__ inline double BlockSum(double value, int thread, double* shared) {
  shared[thread] = value;
  __syncthreads();
  for (int half = kSumThreads / 2; half > 0; half /= 2) {
    if (thread < half) shared[thread] += shared[thread + half];
    __syncthreads();
  }
  const double sum = shared[0];
  __syncthreads();  // the next sum overwrites it
  return sum;
}

}  // namespace oraclegs::cuda
