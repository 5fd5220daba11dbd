#pragma once
// Group norm of maps whose channels lie last in memory, with its neighbors in a residual block
// (docs/method.md#seva-group-norm): an offset before, SiLU and a modulation by rays after.

#include <cuda_runtime.h>

#include <cstdint>

#include "oraclegs/core/device_macros.h"

namespace oraclegs::cuda {

inline constexpr int kGroupNormChannels = 2560, kGroupNormGroups = 64, kGroupNormRays = 8;  ///< largest values
inline constexpr int kGroupNormPixelsABlock = 64;

/// Pointers are to bfloat16 bits in device memory. It computes in float32; the sums of blocks of pixels are added in
/// float64.
struct GroupNorm {
  int64_t images = 0;
  int pixels = 0, channels = 0;  ///< an even number of channels in each group
  int groups = 0;
  const uint16_t* x = nullptr;                        ///< [images, pixels, channels]
  const uint16_t* offsets = nullptr;                  ///< [images, channels], added to x first; null: nothing
  const uint16_t *weight = nullptr, *bias = nullptr;  ///< [channels]
  float eps = 0;
  bool silu = false;  ///< y sigmoid(y) follows
  // rays > 0: y (1 + scale) + shift follows, where a product with the pixel's rays gives scales and shifts
  int rays = 0;
  const uint16_t* ray_maps = nullptr;    ///< [images, pixels, rays]
  const uint16_t* ray_weight = nullptr;  ///< [2 channels, rays]: rows of scales, then rows of shifts
  const uint16_t* ray_bias = nullptr;    ///< [2 channels]
  uint16_t* out = nullptr;               ///< receives [images, pixels, channels]; may be x
};

struct GroupNormPair {
  float a, b;
};
/// Scratch in device memory.
struct GroupNormScratch {
  GroupNormPair* sums = nullptr;     ///< [GroupNormSums]
  GroupNormPair* factors = nullptr;  ///< [images, channels]
};
ORACLEGS_HD inline int GroupNormChunks(const GroupNorm& in) {
  return (in.pixels + kGroupNormPixelsABlock - 1) / kGroupNormPixelsABlock;
}
inline int64_t GroupNormSums(const GroupNorm& in) { return in.images * GroupNormChunks(in) * in.groups; }

/// Queues the work.
void RunGroupNorm(const GroupNorm& in, const GroupNormScratch& scratch, cudaStream_t stream);

}  // namespace oraclegs::cuda
