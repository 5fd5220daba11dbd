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

/// A Gaussian for the reach test.
struct Reach {
  float mx, my;
  ReachTerms<float> terms;
};

__device__ inline Reach ReachOf(const Splat& s) {
  return {s.mx, s.my, ReachTermsOf(s.ax, s.by, s.slope, s.log2_opacity)};
}

/// Whether alpha may be 1/255 between the pixel centers (x, y) and (x + span_x, y + span_y).
__device__ inline bool Reaches(const Reach& r, float x, float y, float span_x, float span_y) {
  return Reaches(r.terms, x - r.mx, y - r.my, span_x, span_y);
}

__device__ inline bool ReachesTile(const Reach& r, int tile_x, int tile_y) {
  constexpr float kSpan = kTile - 1;
  return Reaches(r, static_cast<float>(tile_x * kTile) + 0.5f, static_cast<float>(tile_y * kTile) + 0.5f, kSpan, kSpan);
}

}  // namespace oraclegs::cuda
