#pragma once
// Attention over the frames at one pixel (docs/method.md#seva-multi-view-transformer): many short sequences, whose
// tokens lie a frame apart in memory and are read from there.

#include <cuda_runtime.h>

#include <cstdint>

namespace oraclegs::cuda {

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

}  // namespace oraclegs::cuda
