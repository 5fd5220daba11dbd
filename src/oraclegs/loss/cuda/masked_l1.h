#pragma once
// The terms of depth and alpha on a GPU; what loss/masked_l1.h is on the CPU.

#include <cuda_runtime.h>

#include <cstdint>

#include "oraclegs/loss/cuda/device_image.h"

namespace oraclegs::cuda {

inline constexpr int kMaskedL1PixelsABlock = 1024;

/// All [H,W] and the device's memory.
struct MaskedL1Input {
  int64_t pixels = 0;
  const float* rendered = nullptr;
  DeviceImage target;
  DeviceImage mask;        ///< how much each pixel counts; null = 1
  float scale = 0;         ///< weight / pixels
  double* sums = nullptr;  ///< [MaskedL1Blocks] receives sums of |rendered - target| mask
  float* grad = nullptr;   ///< receives scale * sign(rendered - target) * mask
};

inline int64_t MaskedL1Blocks(int64_t pixels) { return (pixels + kMaskedL1PixelsABlock - 1) / kMaskedL1PixelsABlock; }

/// Queues the work.
void RunMaskedL1(const MaskedL1Input& in, cudaStream_t stream);

}  // namespace oraclegs::cuda
