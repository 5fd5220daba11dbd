#pragma once
// Helpers of several kernels.

#include "oraclegs/core/cuda/launch.h"
#include "oraclegs/render/blend_math-inl.h"
#include "oraclegs/render/color_math-inl.h"
#include "oraclegs/render/cuda/splats.h"
#include "oraclegs/render/splat_math-inl.h"

namespace oraclegs::cuda {

inline constexpr int kShRow = 48;        ///< floats of a Gaussian's SH
inline constexpr int kShRowStride = 49;  ///< row stride in shared memory: no two rows in one bank
inline constexpr int kShThreads = 128;   ///< threads of a block that holds its SH rows in shared memory

__device__ inline int64_t ThreadInGrid() { return int64_t{blockIdx.x} * blockDim.x + threadIdx.x; }
__device__ inline int LaneInWarp() { return static_cast<int>(threadIdx.x % kWarp); }

__device__ inline RawSplat<float> LoadRaw(const GaussianParameters& p, int64_t i) {
  const float *m = p.means + 3 * i, *s = p.log_scales + 3 * i;
  const float4 q = reinterpret_cast<const float4*>(p.quats)[i];
  return {{m[0], m[1], m[2]}, {s[0], s[1], s[2]}, q.x, q.y, q.z, q.w, p.opacity_logits[i]};
}

/// Copies the SH rows of the warp's Gaussians in `mask` (lane 0 has `first`) to `rows` [32, kShRowStride], at least
/// `floats` of each. All lanes take part, so that memory is read in whole lines.
__device__ inline void LoadShRows(const float* sh, int64_t first, unsigned mask, int floats, float* rows) {
  const int chunks = (floats + 3) / 4;
  __syncwarp();
  for (int item = LaneInWarp(); item < kWarp * chunks; item += kWarp) {
    const int row = item / chunks, chunk = item % chunks;
    if (!(mask >> row & 1)) continue;
    const float4 v = reinterpret_cast<const float4*>(sh + (first + row) * kShRow)[chunk];
    float* to = rows + row * kShRowStride + 4 * chunk;
    to[0] = v.x, to[1] = v.y, to[2] = v.z, to[3] = v.w;
  }
  __syncwarp();
}

/// A row of SH coefficients, for color_math-inl.h.
struct ShRow {
  const float* row;

  __device__ float Get(int k, int c) const { return row[3 * k + c]; }
};

}  // namespace oraclegs::cuda
