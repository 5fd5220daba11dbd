#pragma once
// The terms of depth and alpha on a GPU; loss/depth_losses.h is their CPU version.

#include <cuda_runtime.h>

#include <cstdint>

#include "oraclegs/loss/cuda/device_image.h"

namespace oraclegs::cuda {

inline constexpr int kMaskedL1PixelsABlock = 1024;

/// Planes [H,W] in device memory.
struct MaskedL1Input {
  int64_t pixels = 0;
  const float* rendered = nullptr;
  DeviceImage target;
  DeviceImage mask;        ///< weight of each pixel; null = 1
  float scale = 0;         ///< weight / pixels
  double* sums = nullptr;  ///< [MaskedL1Blocks] receives sums of |rendered - target| mask
  float* grad = nullptr;   ///< receives scale * sign(rendered - target) * mask
};

inline int64_t MaskedL1Blocks(int64_t pixels) { return (pixels + kMaskedL1PixelsABlock - 1) / kMaskedL1PixelsABlock; }

/// Queues the sums and the gradient.
void RunMaskedL1(const MaskedL1Input& in, cudaStream_t stream);

}  // namespace oraclegs::cuda
