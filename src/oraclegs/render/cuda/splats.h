#pragma once
// What the stages of the CUDA rasteriser hand to each other: plain memory on the device.
//
// project -> count tiles -> sort by depth -> list pairs -> sort by tile -> blend | blend backward -> Gaussian backward
//
// A pair is one Gaussian in one tile. Pairs are numbered Gaussian after Gaussian in the order of depth; a tile's list
// holds the numbers of its pairs, near to far, in buckets of 32.

#include <cuda_runtime.h>

#include <cstdint>

#include "oraclegs/render/constants.h"
#include "oraclegs/render/splat_camera.h"
#include "oraclegs/render/splats.h"

namespace oraclegs::cuda {

inline constexpr int kBucket = 32;      ///< neighbours in a tile's list, one warp in the backward pass
inline constexpr int kRecord = 10;      ///< floats of one pair's gradient
inline constexpr int kStateFloats = 5;  ///< of a pixel at the start of a bucket: transmittance, rgb, inverse depth

/// [begin, end) in the sorted list of pairs.
struct alignas(8) TileRange {
  uint32_t begin, end;
};

/// 32 consecutive entries of a tile's list, for which the state of the pixels was kept.
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

/// What the backward pass reads of the forward pass, by tile and thread: [tiles, 256].
struct PixelEnds {
  float4* sums;  ///< rgb and inverse depth, without background
  float* transmittance;
  uint32_t* end;  ///< first entry of the tile's list that does not contribute to the pixel
};

/// Buckets that some pixel reached, in any order.
struct BucketStates {
  Bucket* buckets;
  float* states;      ///< [buckets, kStateFloats, 256]
  uint32_t capacity;  ///< buckets; later ones are only counted
};

/// What the last stage, the gradients of Gaussians, reads. Valid until the next Forward.
struct GaussianBackwardInput {
  SplatCamera<float> camera;
  GaussianParameters parameters;
  const uint32_t *begins, *counts;  ///< [n] pairs of each Gaussian: number of the first, how many
  const float* records;             ///< [pairs, kRecord], see BlendBackward
  cudaStream_t stream;              ///< where the stage is queued
};

}  // namespace oraclegs::cuda
