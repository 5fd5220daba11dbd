#pragma once
// Falloff of one Gaussian at a pixel, and the pixels it can reach: formulas that several kernels must compute to the
// same bits.

#include "oraclegs/core/cuda/fast_math-inl.cuh"
#include "oraclegs/render/cuda/warp-inl.cuh"

namespace oraclegs::cuda {

/// log2 of alpha before its cap, at (dx, dy) from the center. Fused by hand: the compiler may not choose another
/// rounding in another kernel.
__device__ inline float Log2Alpha(const Splat& s, float dx, float dy) {
  const float p = s.ax * dx, q = s.by * fmaf(s.slope, dx, dy);
  return fmaf(-q, q, fmaf(-p, p, s.log2_opacity));
}

/// The transmittance after a Gaussian.
__device__ inline float NextTransmittance(float alpha, float transmittance) {
  return fmaf(-alpha, transmittance, transmittance);
}

/// Position of thread `i` of 256 within the tile: each warp has 8 x 4 pixels.
__device__ inline int PixelX(int i) { return i / kWarp % 2 * 8 + i % 8; }
__device__ inline int PixelY(int i) { return i / (2 * kWarp) * 4 + i % kWarp / 8; }

/// Terms of the reach test of a Gaussian.
struct Reach {
  float mx, my, ax, by, slope, across, bound;
};

__device__ inline Reach ReachOf(const Splat& s) {
  // The sum of squares is smallest, for a fixed dx, at dy = -slope dx; for a fixed dy at dx = across dy.
  const float tilt = s.by * s.by * s.slope;
  // alpha >= 1/255 <=> sum <= bound. The slack covers rounding here and in the blend loop, also of needles whose
  // center is far away.
  return {s.mx,
          s.my,
          s.ax,
          s.by,
          s.slope,
          -tilt / fmaf(s.ax, s.ax, tilt * s.slope),
          s.log2_opacity - kLog2AlphaMin + 1e-3f};
}

/// Whether alpha may be 1/255 between the pixel centers (x, y) and (x + span_x, y + span_y): the exact minimum of the
/// quadratic form over that rectangle, which lies on the edge nearest in x or on the one nearest in y. Fused by hand,
/// as one kernel counts by it and another lists.
__device__ inline bool Reaches(const Reach& r, float x, float y, float span_x, float span_y) {
  const float x0 = x - r.mx, x1 = x0 + span_x, y0 = y - r.my, y1 = y0 + span_y;
  const float near_x = Max(x0, Min(x1, 0.f)), near_y = Max(y0, Min(y1, 0.f));
  const float best_y = Max(y0, Min(y1, -r.slope * near_x)), best_x = Max(x0, Min(x1, r.across * near_y));
  const float p1 = r.ax * near_x, q1 = r.by * fmaf(r.slope, near_x, best_y);
  const float p2 = r.ax * best_x, q2 = r.by * fmaf(r.slope, best_x, near_y);
  return Min(fmaf(p1, p1, q1 * q1), fmaf(p2, p2, q2 * q2)) <= r.bound;
}

__device__ inline bool ReachesTile(const Reach& r, int tile_x, int tile_y) {
  constexpr float kSpan = kTile - 1;
  return Reaches(r, static_cast<float>(tile_x * kTile) + 0.5f, static_cast<float>(tile_y * kTile) + 0.5f, kSpan, kSpan);
}

}  // namespace oraclegs::cuda
