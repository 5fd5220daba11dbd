#pragma once
// Fused L1 + SSIM on a GPU, value and gradient (docs/method.md#ssim); what loss/photometric.h and the mask of
// train/loss_terms.h are on the CPU.

#include <cuda_runtime.h>

#include <cstdint>

#include "oraclegs/loss/cuda/device_image.h"
#include "oraclegs/loss/mask_meaning.h"

namespace oraclegs::cuda {

/// Pixels of a tile: one block of threads works on it.
inline constexpr int kPhotometricTileWidth = 32, kPhotometricTileHeight = 16;

/// Sums of one tile's pixels and channels.
struct PhotometricSums {
  double l1;     ///< |render - target| U
  double dssim;  ///< (1 - S) U
};

/// All memory is the device's.
struct PhotometricInput {
  int width = 0, height = 0;
  const float* render = nullptr;  ///< [H,W,3]
  DeviceImage target;             ///< [H,W,3]
  DeviceImage confidence;         ///< [H,W]; not there: 1 everywhere
  MaskMeaning meaning = MaskMeaning::kConfidence;
  float l1_scale = 0;     ///< dL/d(sum |render - target| U)
  float dssim_scale = 0;  ///< dL/d(sum (1 - S) U)
};

struct PhotometricOutput {
  PhotometricSums* sums = nullptr;  ///< [PhotometricTiles], one of each tile
  float* derivatives = nullptr;     ///< [9,H,W], scratch: dL/d(mean, variance, covariance) of each window and channel
  float* grad = nullptr;            ///< [H,W,3] dL/d(render)
};

inline int64_t PhotometricTiles(int width, int height) {
  const int64_t columns = (width + kPhotometricTileWidth - 1) / kPhotometricTileWidth;
  return columns * ((height + kPhotometricTileHeight - 1) / kPhotometricTileHeight);
}
inline int64_t PhotometricDerivatives(int width, int height) { return int64_t{9} * width * height; }

/// Queues the work; nothing is waited for.
void RunPhotometric(const PhotometricInput& in, const PhotometricOutput& out, cudaStream_t stream);

}  // namespace oraclegs::cuda
