#pragma once
// Plain device memory that the stages of the CUDA rasterizer hand to each other.
//
// project -> count tiles -> sort by depth -> list pairs -> sort by tile -> blend | blend backward -> Gaussian backward
//
// A pair is one Gaussian in one tile. Pairs are numbered Gaussian after Gaussian in the order of depth; a tile's list
// holds the numbers of its pairs, near to far, in runs of 32. One run or several make a bucket, before which the
// state of the tile's pixels is kept for the backward pass.

#include <cuda_runtime.h>

#include <cstdint>

#include "oraclegs/render/constants.h"
#include "oraclegs/render/splat_camera.h"
#include "oraclegs/render/splats.h"

namespace oraclegs::cuda {

inline constexpr int kRun = 32;         ///< neighbors in a tile's list that a warp processes at once
inline constexpr int kMaxRuns = 4;      ///< maximum number of runs per bucket
inline constexpr int kRecord = 10;      ///< floats of one pair's gradient
inline constexpr int kStateFloats = 5;  ///< per pixel at the start of a bucket: transmittance, rgb, inverse depth

/// [begin, end) in the sorted list of pairs.
struct alignas(8) TileRange {
  uint32_t begin, end;
};

/// Consecutive entries of a tile's list; the state of the pixels before them was kept.
struct alignas(8) Bucket {
  uint32_t tile, first;  ///< first: first entry, counted from the tile's begin
};

/// Counts of the kernels; zero before each Forward.
struct Counters {
  unsigned long long visible, pairs;  ///< pairs: exact, also where there is memory for fewer
  unsigned long long pixel_pairs, pixel_pairs_backward;
  unsigned buckets;
};

/// Images of one render, on the device: [H,W,3], [H,W], [H,W].
struct ImagePlanes {
  float *image, *alpha, *inv_depth;
};

/// Buckets that some pixel reached, in any order.
struct BucketStates {
  Bucket* buckets;
  float* states;      ///< [buckets, kStateFloats, 256]
  uint32_t capacity;  ///< buckets; later ones are only counted
  uint32_t runs;      ///< runs per bucket: 1, 2 or kMaxRuns

  ORACLEGS_HD inline uint32_t Length() const { return runs * kRun; }
};

/// Inputs of the last stage, the gradients of Gaussians. Valid until the next Forward.
struct GaussianBackwardInput {
  SplatCamera<float> camera;
  GaussianParameters parameters;
  const uint32_t *begins, *counts;  ///< [n] pairs of each Gaussian: number of the first, count
  const float* records;             ///< [pairs, kRecord], see BlendBackward
  cudaStream_t stream;              ///< where the stage is queued
  float* screen_sums = nullptr;     ///< [n] added to ScreenGradients::sum; null = not watched
  float* screen_views = nullptr;    ///< [n] added to ScreenGradients::views
  float* camera_sums = nullptr;     ///< [kCameraSums, WarpsOf(n)] sums over a warp's Gaussians; null = not watched
};

/// Warps of the last stage, which has one thread per Gaussian.
ORACLEGS_HD inline int64_t WarpsOf(int64_t n) { return (n + kRun - 1) / kRun; }

struct CameraSums {
  double of[kCameraSums];
};

}  // namespace oraclegs::cuda
