#pragma once
// Stage 1, one thread a Gaussian: projection and color (docs/method.md#projection, #spherical-harmonics).

#include <cuda_runtime.h>

#include "oraclegs/gaussians/gaussian_rows.h"
#include "oraclegs/render/cuda/splats.h"

namespace oraclegs::cuda {

/// Fills rects[n] (empty where invisible) and, where they are not empty, splats[n].
void ProjectSplats(const SplatCamera<float>& camera, const GaussianParameters& parameters, Splat* splats,
                   TileRect* rects, cudaStream_t stream);

// Stage 2: the tiles that each Gaussian reaches, exactly, and each tile's list, near to far.

/// Output of the tile count of n Gaussians, [n] each.
struct TileCountOutput {
  uint32_t* counts;      ///< tiles that the Gaussian reaches
  uint32_t* depth_keys;  ///< integers that sort like the depths; unseen ones last
  uint32_t* ids;         ///< 0 .. n - 1
  Counters* counters;    ///< visible, pairs
};
void CountTiles(const Splat* splats, const TileRect* rects, int64_t n, const TileCountOutput& out, cudaStream_t stream);

/// Sets in_order[r] = counts[ids[r]].
void GatherCounts(const uint32_t* counts, const uint32_t* ids, int64_t n, uint32_t* in_order, cudaStream_t stream);

struct PairInput {
  const Splat* splats;
  const TileRect* rects;
  const uint32_t *ids, *offsets;  ///< in order of depth: Gaussian, number of its first pair
  int64_t n;
  int tiles_x;
};
struct PairOutput {
  uint32_t *tiles, *numbers, *gaussians;  ///< by pair: its tile, its number, its Gaussian
  uint32_t* begins;                       ///< by Gaussian: number of its first pair
  int64_t capacity;                       ///< pairs beyond it are not written
};
/// Lists the pairs. The tiles of one Gaussian are in reading order.
void ListPairs(const PairInput& in, const PairOutput& out, cudaStream_t stream);

/// Pairs sorted by tile; entries past the last pair have a tile of at least `tiles`.
struct RangeInput {
  const uint32_t *sorted_tiles, *sorted_numbers, *gaussians;
  int64_t pairs;
  uint32_t tiles;
};
/// Finds each tile's range. ranges[tiles] must be zero before; entry_ids[i] becomes the Gaussian of sorted pair i.
void FindTileRanges(const RangeInput& in, TileRange* ranges, uint32_t* entry_ids, cudaStream_t stream);

// Stage 3: blending (docs/method.md#blending) and its adjoint (#blending-gradient).

struct BlendInput {
  SplatCamera<float> camera;
  const Splat* splats;
  const uint32_t* entry_ids;  ///< Gaussian of each sorted pair
  const TileRange* ranges;    ///< [tiles]
  int64_t listed;             ///< capacity of the lists, pairs
};

/// State kept for the backward pass beside the image. Null: nothing is kept.
struct BlendKept {
  uint32_t* ends;  ///< [tiles, 256] first entry of the tile's list that does not contribute to the pixel
  BucketStates buckets;
};

/// Blends with one block per tile, one thread per pixel. Writes no image where `out` is null. Counts pixel_pairs and
/// buckets. Writes nothing where counters->pairs is above in.listed.
void BlendForward(const BlendInput& in, const ImagePlanes& out, const BlendKept& kept, Counters* counters,
                  cudaStream_t stream);

struct BlendBackwardInput {
  BlendInput forward;
  ImagePlanes image;  ///< as BlendForward wrote it
  BlendKept kept;
  UpstreamPlanes upstream;
  const uint32_t* sorted_numbers;  ///< pair number of each sorted pair
  int64_t buckets;                 ///< filled buckets
};

/// Runs one block per bucket. Each warp takes patches of 8 x 4 pixels, a lane each, past the Gaussians that reach them,
/// as the forward pass did, and keeps each pixel's contribution to 16 Gaussians. Then each lane sums over the pixels
/// for a Gaussian, in a fixed order; no two threads add to one place. Writes records[pair] of the pairs in these
/// buckets, kRecord floats each.
/// With (dx, dy) from the Gaussian to a pixel, h = alpha dL/d(alpha) (0 where capped), w = alpha T, a record is:
/// [0] sum h  [1] h dx  [2] h dy  [3] h dx^2  [4] h dx dy  [5] h dy^2  [6..8] w dL/d(rgb)  [9] w dL/d(inv_depth)
void BlendBackward(const BlendBackwardInput& in, float* records, Counters* counters, cudaStream_t stream);

// Stage 4: from the records of pairs to the raw parameters (docs/method.md#gaussian-gradient).

/// Writes all rows of `grads`; of sh only the coefficients of the active degree.
void WriteGaussianGrads(const GaussianBackwardInput& in, const GaussianRows& grads);

/// Adds the rows of GaussianBackwardInput::camera_sums up, of `warps` numbers each, in a fixed order.
void AddCameraSums(const float* of_warps, int64_t warps, CameraSums* sums, cudaStream_t stream);

}  // namespace oraclegs::cuda
