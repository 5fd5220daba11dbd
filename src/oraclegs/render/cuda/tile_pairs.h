#pragma once
// Stage 2: the tiles that each Gaussian reaches, exactly, and each tile's list, near to far.

#include "oraclegs/render/cuda/splats.h"

namespace oraclegs::cuda {

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

}  // namespace oraclegs::cuda
