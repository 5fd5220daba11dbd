#pragma once

#include <cstdint>
#include <vector>

#include "oraclegs/render/cpu/kernels.h"

namespace oraclegs::cpu {

/// For each tile the Gaussians that reach it, near to far, and for each Gaussian where its pairs lie. Buffers grow to
/// the largest use and stay.
class TileLists {
 public:
  std::vector<int64_t> tile_begin;  ///< [tiles + 1] into entries
  std::vector<TileEntry> entries;   ///< [pairs], tile by tile, by depth, ties by index
  std::vector<PairRange> ranges;    ///< [N] into pair_slot and pair_tile
  std::vector<uint32_t> pair_slot;  ///< position in entries, Gaussian by Gaussian
  std::vector<uint32_t> pair_tile;  ///< tile number, Gaussian by Gaussian
  int64_t visible = 0;              ///< Gaussians with at least one pair
  int64_t pairs = 0;

  /// rects[i] empty = not visible. Throws RunError when there are more than 2^32 candidate pairs.
  void Build(const Splat* splats, const TileRect* rects, int64_t n, int tiles_x, int tiles_y);

 private:
  struct Key {
    uint32_t depth_bits, id;
  };
  /// A stretch of Gaussians in index order, one task.
  struct Chunk {
    int64_t candidates = 0;       // tiles of their rectangles
    int64_t first_candidate = 0;  // sum over the chunks before
    int64_t pairs = 0, visible = 0;
    int64_t first_visible = 0;
  };

  void Cover(const Splat* splats, const TileRect* rects, int64_t n, int tiles_x);
  void SortByDepth();
  void Deal(int64_t tiles);

  std::vector<Chunk> chunks_;
  std::vector<Key> keys_, keys_swap_;  // of the visible
  std::vector<uint32_t> histogram_;    // [chunks, buckets]
  std::vector<int64_t> digit_begin_;   // [buckets + 1]
};

}  // namespace oraclegs::cpu
