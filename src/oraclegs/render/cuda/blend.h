#pragma once
// Stage 3: blending (docs/method.md#blending) and its adjoint (#blending-gradient).

#include "oraclegs/render/cuda/splats.h"

namespace oraclegs::cuda {

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

}  // namespace oraclegs::cuda
