#pragma once
// Small things that several kernels do.

#include "oraclegs/core/cuda/launch.h"
#include "oraclegs/render/cuda/splats.h"
#include "oraclegs/render/splat_math-inl.h"

namespace oraclegs::cuda {

inline constexpr int kShRow = 48;        ///< floats of a Gaussian's SH
inline constexpr int kShRowStride = 49;  ///< in shared memory: no two rows in one bank
inline constexpr int kShThreads = 128;   ///< of a block that holds its SH rows in shared memory

__device__ inline int64_t ThreadInGrid() { return int64_t{blockIdx.x} * blockDim.x + threadIdx.x; }
__device__ inline int LaneInWarp() { return static_cast<int>(threadIdx.x % kWarp); }

template <class T>
__device__ inline T WarpSum(T value) {
  for (int step = kWarp / 2; step > 0; step /= 2) value += __shfl_xor_sync(kAllLanes, value, step);
  return value;
}

__device__ inline SplatCamera<float> CameraOf(const View& view) {
  SplatCamera<float> c;
  for (int i = 0; i < 9; ++i) c.r[i] = view.r[i];
  for (int i = 0; i < 3; ++i) c.t[i] = view.t[i], c.eye[i] = view.eye[i];
  c.fx = view.fx, c.fy = view.fy, c.cx = view.cx, c.cy = view.cy;
  c.min_u = view.min_u, c.max_u = view.max_u, c.min_v = view.min_v, c.max_v = view.max_v;
  return c;
}

__device__ inline RawSplat<float> LoadRaw(const Parameters& p, int64_t i) {
  const float *m = p.means + 3 * i, *s = p.log_scales + 3 * i;
  const float4 q = reinterpret_cast<const float4*>(p.quats)[i];
  return {{m[0], m[1], m[2]}, {s[0], s[1], s[2]}, q.x, q.y, q.z, q.w, p.opacity_logits[i]};
}

/// The SH rows of the warp's Gaussians (lane 0 has `first`) whose lane is in `mask` go to `rows` [32, kShRowStride], at
/// least `floats` of each. All lanes take part, so that memory is read in whole lines.
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

/// Unit vector from the camera to the Gaussian, and one over its distance.
__device__ inline Vec3<float> ViewDirection(const Vec3<float>& mean, const View& view, float* inv_distance) {
  const Vec3<float> d{mean.x - view.eye[0], mean.y - view.eye[1], mean.z - view.eye[2]};
  *inv_distance = 1.f / Sqrt(Dot(d, d));
  return {d.x * *inv_distance, d.y * *inv_distance, d.z * *inv_distance};
}

/// Colour before the clamp at zero; `sh`: one row.
__device__ inline Vec3<float> RawColor(const float* sh, const float* basis, int coefficients) {
  Vec3<float> c{0.5f, 0.5f, 0.5f};
  for (int k = 0; k < coefficients; ++k) {
    c.x = fmaf(basis[k], sh[3 * k], c.x);
    c.y = fmaf(basis[k], sh[3 * k + 1], c.y);
    c.z = fmaf(basis[k], sh[3 * k + 2], c.z);
  }
  return c;
}

}  // namespace oraclegs::cuda
