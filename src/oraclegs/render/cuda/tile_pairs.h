#pragma once
// Stage 2: which tiles each Gaussian reaches, exactly, and each tile's list, near to far.

#include "oraclegs/render/cuda/splats.h"

namespace oraclegs::cuda {

/// Of n Gaussians.
struct TileCountOutput {
  uint32_t* counts;      ///< tiles that the Gaussian reaches
  uint32_t* depth_keys;  ///< sort like the depths; unseen ones last
  uint32_t* ids;         ///< 0 .. n - 1
  Counters* counters;    ///< visible, pairs
};
void CountTiles(const Splat* splats, const TileRect* rects, int64_t n, const TileCountOutput& out, cudaStream_t stream);

/// in_order[r] = counts[ids[r]].
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
  int64_t capacity;                       ///< pairs beyond are not written
};
/// Tiles of one Gaussian in reading order.
void ListPairs(const PairInput& in, const PairOutput& out, cudaStream_t stream);

/// Of pairs sorted by tile; entries past the last pair have a tile of at least `tiles`.
struct RangeInput {
  const uint32_t *sorted_tiles, *sorted_numbers, *gaussians;
  int64_t pairs;
  uint32_t tiles;
};
/// ranges[tiles] must be zero before; entry_ids[i] is the Gaussian of sorted pair i.
void FindTileRanges(const RangeInput& in, TileRange* ranges, uint32_t* entry_ids, cudaStream_t stream);

}  // namespace oraclegs::cuda
