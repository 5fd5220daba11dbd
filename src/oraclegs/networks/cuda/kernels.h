#pragma once
// Kernels for the layers of SEVA (networks/seva/kernels.h calls them with tensors).

#include <cuda_runtime.h>

#include <cstdint>

#include "oraclegs/core/device_macros.h"

namespace oraclegs::cuda {

// Sums of rows and the layer norm of the sum, in one pass over memory.

/// Largest width that AddNorm takes; widths are even.
inline constexpr int kAddNormWidth = 1280;

/// sum = x + added + the vector of the row's group; normed = layer norm of that sum. Pointers are to bfloat16 bits in
/// device memory. It computes in float32, the norm from the sum before rounding.
struct AddNorm {
  int64_t rows = 0;
  int width = 0;
  const uint16_t* x = nullptr;        ///< [rows, width]
  const uint16_t* added = nullptr;    ///< [rows, width]; null: nothing
  const uint16_t* vectors = nullptr;  ///< [rows / rows_a_vector, width]; null: nothing
  int64_t rows_a_vector = 1;
  uint16_t* sum = nullptr;                            ///< receives [rows, width]; may be x; null: not wanted
  const uint16_t *weight = nullptr, *bias = nullptr;  ///< [width]
  float eps = 0;
  uint16_t* normed = nullptr;  ///< receives [rows, width]; null: not wanted
};
/// Queues the work.
void RunAddNorm(const AddNorm& in, cudaStream_t stream);

// Attention over the frames at one pixel (docs/method.md#seva-multi-view-transformer): many short sequences, whose
// tokens lie a frame apart in memory and are read from there.

inline constexpr int kFrameAttentionWidth = 64;   ///< width of a head
inline constexpr int kFrameAttentionFrames = 24;  ///< largest number of frames

/// softmax(q k^T / 8) v of each head, pixel and batch. Pointers are to bfloat16 bits in device memory; it computes in
/// float32.
struct FrameAttention {
  int64_t batch = 0, pixels = 0;
  int frames = 0, heads = 0;
  const uint16_t* qkv = nullptr;  ///< [batch, frames, pixels, 3, heads, 64]: queries, keys, values
  uint16_t* out = nullptr;        ///< [batch, frames, pixels, heads, 64]
};
/// Queues the work.
void RunFrameAttention(const FrameAttention& in, cudaStream_t stream);

// Gate of a feed-forward layer: a * GELU(g), where one product gives a and g side by side
// (docs/method.md#seva-multi-view-transformer).

/// Pointers are to bfloat16 bits in device memory.
struct GatedGelu {
  int64_t rows = 0;
  int width = 0;                   ///< width of the result, a multiple of 8
  const uint16_t* both = nullptr;  ///< [rows, 2 width]: values, then gates
  uint16_t* out = nullptr;         ///< [rows, width]
};
/// Queues the work. It computes in float32, with GELU's error function to 2e-7.
void RunGatedGelu(const GatedGelu& in, cudaStream_t stream);

// Group norm of maps whose channels lie last in memory, with its neighbors in a residual block
// (docs/method.md#seva-group-norm): an offset before, SiLU and a modulation by rays after.

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
