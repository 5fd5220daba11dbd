#pragma once

#include <cstdint>
#include <vector>

#include "oraclegs/render/cpu/kernels.h"

namespace oraclegs::cpu {

/// For each tile the Gaussians that reach it, near to far, and for each Gaussian where its pairs lie. Buffers grow to
/// the largest use and stay.
struct TileLists {
  std::vector<uint32_t> order;      ///< visible Gaussians by depth, ties by index
  std::vector<int64_t> tile_begin;  ///< [tiles + 1] into entries
  std::vector<TileEntry> entries;   ///< [pairs], tile by tile
  std::vector<PairRange> ranges;    ///< [N] into pair_slot and pair_tile
  std::vector<uint32_t> pair_slot;  ///< position in entries, Gaussian by Gaussian
  std::vector<uint32_t> pair_tile;  ///< tile number, Gaussian by Gaussian
  int64_t pairs = 0;

  /// rects[i] empty = not visible. Throws RunError when there are more than 2^32 candidate pairs.
  void Build(const Splat* splats, const TileRect* rects, int64_t n, int tiles_x, int tiles_y);

 private:
  void SortByDepth(const Splat* splats, const TileRect* rects, int64_t n);

  struct Key {
    uint32_t depth_bits, id;
  };
  std::vector<Key> keys_, keys_swap_;
  std::vector<uint32_t> histogram_;       // [chunks, buckets] while sorting, [chunks, tiles] while binning
  std::vector<TileEntry> local_entries_;  // the chunks' pairs before they are dealt to tiles
  std::vector<int64_t> candidate_begin_;  // [visible + 1] prefix sum of candidate tiles
};

}  // namespace oraclegs::cpu
