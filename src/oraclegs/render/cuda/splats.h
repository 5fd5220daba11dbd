#pragma once
// What the stages of the CUDA rasteriser hand to each other: plain memory on the device.
//
// project -> count tiles -> sort by depth -> list pairs -> sort by tile -> blend | blend backward -> Gaussian backward
//
// A pair is one Gaussian in one tile. Pairs are numbered Gaussian after Gaussian in the order of depth; a tile's list
// holds the numbers of its pairs, near to far, in buckets of 32.

#include <cuda_runtime.h>

#include <cstdint>

namespace oraclegs::cuda {

inline constexpr int kTile = 16;         ///< pixels a side
inline constexpr int kTilePixels = 256;  ///< one thread each
inline constexpr int kBucket = 32;       ///< neighbours in a tile's list, one warp in the backward pass
inline constexpr int kRecord = 10;       ///< floats of one pair's gradient
inline constexpr int kStateFloats = 5;   ///< of a pixel at the start of a bucket: transmittance, rgb, inverse depth

/// A camera and how to render, as kernels take it.
struct View {
  float r[9], t[3], eye[3];  ///< world to camera, row-major; centre
  float fx, fy, cx, cy, min_u, max_u, min_v,
      max_v;  ///< pixels; clamp of the linearisation point (docs/method.md#projection)
  int width, height, tiles_x, tiles_y;
  int sh_degree;
  bool antialiased;
  float background[3];

  int64_t tiles() const { return int64_t{tiles_x} * tiles_y; }
};

/// Raw parameters of n Gaussians, rows as in GaussianRows. sh is aligned to 16 bytes.
struct Parameters {
  const float *means, *log_scales, *quats, *opacity_logits, *sh;
  const float* opacity_factors;  ///< or null: all are 1; the backward pass needs none
  int64_t n;
};

/// One Gaussian as the blend loop reads it. With d = pixel - centre its falloff is
/// exp2(log2_opacity - (ax dx)^2 - (by (dy + slope dx))^2), as in cpu/kernels.h.
struct alignas(16) Splat {
  float mx, my, ax, by;  ///< px, whole image; 1/px
  float slope, log2_opacity, depth, unused;
  float r, g, b, inv_z;
};
static_assert(sizeof(Splat) == 48);

/// Tiles that a Gaussian may reach: [x0, x1) x [y0, y1). Empty: not visible.
struct alignas(8) TileRect {
  uint16_t x0, y0, x1, y1;
};

/// [begin, end) in the sorted list of pairs.
struct alignas(8) TileRange {
  uint32_t begin, end;
};

/// 32 neighbours of a tile's list whose pixels' state was kept.
struct alignas(8) Bucket {
  uint32_t tile, first;  ///< first entry, from the tile's begin
};

/// What kernels count; zero before each Forward.
struct Counters {
  unsigned long long visible, pairs;  ///< pairs: exact, also where memory is for fewer
  unsigned long long pixel_pairs, pixel_pairs_backward;
  unsigned buckets;
};

/// Of one render, on the device: [H,W,3], [H,W], [H,W].
struct ImagePlanes {
  float *image, *alpha, *inv_depth;
};

/// dL/d(plane); null means zero.
struct UpstreamPlanes {
  const float *image, *alpha, *inv_depth;
};

/// What the backward pass reads of the forward pass, by tile and thread: [tiles, 256].
struct PixelEnds {
  float4* sums;  ///< rgb and inverse depth, without background
  float* transmittance;
  uint32_t* end;  ///< entry of the tile's list from which on the pixel takes no part
};

/// Buckets that some pixel reached, in any order.
struct BucketStates {
  Bucket* buckets;
  float* states;      ///< [buckets, kStateFloats, 256]
  uint32_t capacity;  ///< buckets; what comes later is counted only
};

/// What the last stage, the gradients of Gaussians, reads. Valid until the next Forward.
struct GaussianBackwardInput {
  View view;
  Parameters parameters;
  const uint32_t *begins, *counts;  ///< [n] pairs of each Gaussian: number of the first, how many
  const float* records;             ///< [pairs, kRecord], see BlendBackward
  cudaStream_t stream;              ///< where the stage is queued
};

}  // namespace oraclegs::cuda
