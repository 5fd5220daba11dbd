#pragma once
// How kernels are started: by the CUDA runtime, or thread by thread on the host where the tests emulate a device
// (tests/support/emulated_cuda). For .cu files.

#include <cstdint>
#include <utility>

#include "oraclegs/core/cuda/check.h"

#if defined(ORACLEGS_EMULATED_CUDA)
#include "support/emulated_cuda/threads.h"
#endif

namespace oraclegs::cuda {

inline constexpr int kWarp = 32;
inline constexpr unsigned kAllLanes = 0xffffffffu;

/// One-dimensional blocks of threads.
struct LaunchShape {
  int64_t blocks;
  int threads;  ///< a block, a multiple of kWarp

  /// Enough blocks for one thread an item.
  static LaunchShape For(int64_t items, int threads = 256) { return {(items + threads - 1) / threads, threads}; }
};

/// Starts the kernel, unless there is no block to start. `name` stands in the error.
template <class... P, class... A>
void Launch(const char* name, void (*kernel)(P...), LaunchShape shape, cudaStream_t stream, A&&... args) {
  if (shape.blocks == 0) return;
  const dim3 grid(static_cast<unsigned>(shape.blocks)), block(static_cast<unsigned>(shape.threads));
#if defined(ORACLEGS_EMULATED_CUDA)
  static_cast<void>(stream);
  emulated_cuda::RunGrid(name, grid, block, [&] { kernel(static_cast<P>(args)...); });
#else
  cudaLaunchConfig_t config{};
  config.gridDim = grid;
  config.blockDim = block;
  config.stream = stream;
  Check(cudaLaunchKernelEx(&config, kernel, static_cast<P>(std::forward<A>(args))...), name);
#endif
  CheckLaunch(name);
}

/// The sum of all lanes' values, in every lane; always added in the same order.
template <class T>
__device__ inline T WarpSum(T value) {
  for (int step = kWarp / 2; step > 0; step /= 2) value += __shfl_xor_sync(kAllLanes, value, step);
  return value;
}

}  // namespace oraclegs::cuda
