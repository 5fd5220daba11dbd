#pragma once
// The depth term on a GPU; what loss/depth.h is on the CPU.

#include <cuda_runtime.h>

#include <cstdint>

#include "oraclegs/loss/cuda/device_image.h"

namespace oraclegs::cuda {

inline constexpr int kDepthPixelsABlock = 1024;

/// All [H,W] and the device's memory.
struct DepthInput {
  int64_t pixels = 0;
  const float* inv_depth = nullptr;  ///< as rendered
  const float* target = nullptr;
  DeviceImage mask;        ///< how much each pixel counts
  float scale = 0;         ///< weight / pixels
  double* sums = nullptr;  ///< [DepthBlocks] receives sums of |inv_depth - target| mask
  float* grad = nullptr;   ///< receives scale * sign(inv_depth - target) * mask
};

inline int64_t DepthBlocks(int64_t pixels) { return (pixels + kDepthPixelsABlock - 1) / kDepthPixelsABlock; }

/// Queues the work.
void RunDepth(const DepthInput& in, cudaStream_t stream);

}  // namespace oraclegs::cuda
