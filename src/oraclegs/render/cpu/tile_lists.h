#pragma once

#include <cstdint>
#include <vector>

#include "oraclegs/render/cpu/kernels.h"
#include "oraclegs/render/cpu/scratch_array.h"

namespace oraclegs::cpu {

/// For each tile the Gaussians that reach it, near to far, and for each Gaussian its pairs. Buffers grow to the largest
/// use and are reused.
class TileLists {
 public:
  ScratchArray<int64_t> tile_begin;  ///< [tiles + 1] into entries
  ScratchArray<TileEntry> entries;   ///< [pairs], tile by tile, by depth, ties by index
  ScratchArray<PairRange> ranges;    ///< [N] pair numbers
  ScratchArray<uint32_t> pair_tile;  ///< tile number of a pair, by pair number
  int64_t visible = 0;               ///< Gaussians with at least one pair
  int64_t pairs = 0;
  int64_t pair_numbers = 0;  ///< pair numbers are below this; some are unused

  /// Builds the lists. rects[i] empty = not visible. Throws RunError when there are more than 2^32 candidate pairs.
  void Build(const LineSplat* splats, const TileRect* rects, int64_t n, int tiles_x, int tiles_y);

 private:
  struct Key {
    uint32_t depth_bits, id;
  };
  /// A range of Gaussians in index order, one task.
  struct Chunk {
    int64_t candidates = 0;       // tiles of their rectangles
    int64_t first_candidate = 0;  // sum over the chunks before
    int64_t pairs = 0, visible = 0;
    int64_t first_visible = 0;
  };

  void Cover(const LineSplat* splats, const TileRect* rects, int64_t n, int tiles_x);
  void SortByDepth();
  void ScatterToTiles(int64_t tiles);

  std::vector<Chunk> chunks_;
  ScratchArray<uint32_t> pair_mask_;   // by pair number
  ScratchArray<Key> keys_, sorted_;    // of the visible; sorted_ is scratch between the passes
  ScratchArray<uint32_t> histogram_;   // [chunks, buckets]
  ScratchArray<int64_t> digit_begin_;  // [buckets + 1]
};

}  // namespace oraclegs::cpu
