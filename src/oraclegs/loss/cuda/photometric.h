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
  /// [channels_at_once,3,H,W], scratch: dL/d(mean, variance, covariance) of each window.
  float* derivatives = nullptr;
  int channels_at_once = 3;  ///< 3 or 1: in three rounds, with a third of the scratch
  float* grad = nullptr;     ///< [H,W,3] dL/d(render)
};

inline int64_t PhotometricTiles(int width, int height) {
  const int64_t columns = (width + kPhotometricTileWidth - 1) / kPhotometricTileWidth;
  return columns * ((height + kPhotometricTileHeight - 1) / kPhotometricTileHeight);
}
/// Floats of the scratch.
inline int64_t PhotometricDerivatives(int64_t pixels, int channels_at_once) { return 3 * channels_at_once * pixels; }
/// For views of up to so many pixels: large ones have enough tiles to fill a GPU with one channel.
inline int PhotometricChannelsAtOnce(int64_t pixels) { return pixels > 500'000 ? 1 : 3; }

/// Queues the work; nothing is waited for.
void RunPhotometric(const PhotometricInput& in, const PhotometricOutput& out, cudaStream_t stream);

}  // namespace oraclegs::cuda
