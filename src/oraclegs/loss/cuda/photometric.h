#pragma once
// Fused L1 + SSIM on a GPU, value and gradient (docs/method.md#ssim). Its CPU version is loss/photometric.h.

#include <cuda_runtime.h>

#include <cstdint>

#include "oraclegs/loss/cuda/device_image.h"
#include "oraclegs/loss/ssim_window.h"

namespace oraclegs::cuda {

/// Size of a tile in pixels: one block of threads works on it.
inline constexpr int kPhotometricTileWidth = 32, kPhotometricTileHeight = 16;

/// Sums of one tile's pixels and channels.
struct PhotometricSums {
  double l1;     ///< |render - target| U
  double dssim;  ///< (1 - S) U
};

/// Input of RunPhotometric, all in device memory.
struct PhotometricInput {
  int width = 0, height = 0;
  const float* render = nullptr;  ///< [H,W,3]
  DeviceImage target;             ///< [H,W,3]
  DeviceImage confidence;         ///< [H,W]; absent: 1 everywhere
  MaskMeaning meaning = MaskMeaning::kConfidence;
  float l1_scale = 0;     ///< dL/d(sum |render - target| U)
  float dssim_scale = 0;  ///< dL/d(sum (1 - S) U)
};

struct PhotometricOutput {
  PhotometricSums* sums = nullptr;  ///< [PhotometricTiles], one per tile
  /// [channels_at_once,3,H,W], scratch: dL/d(mean, variance, covariance) of each window.
  float* derivatives = nullptr;
  int channels_at_once = 3;  ///< 3, or 1: three rounds with a third of the scratch
  float* grad = nullptr;     ///< [H,W,3] dL/d(render)
};

inline int64_t PhotometricTiles(int width, int height) {
  const int64_t columns = (width + kPhotometricTileWidth - 1) / kPhotometricTileWidth;
  return columns * ((height + kPhotometricTileHeight - 1) / kPhotometricTileHeight);
}
/// Floats of the scratch `derivatives`.
inline int64_t PhotometricDerivatives(int64_t pixels, int channels_at_once) { return 3 * channels_at_once * pixels; }
/// Channels at once for views of up to so many pixels: large views have enough tiles to fill a GPU with one channel.
inline int PhotometricChannelsAtOnce(int64_t pixels) { return pixels > 500'000 ? 1 : 3; }

/// Queues both passes and returns at once.
void RunPhotometric(const PhotometricInput& in, const PhotometricOutput& out, cudaStream_t stream);

}  // namespace oraclegs::cuda
