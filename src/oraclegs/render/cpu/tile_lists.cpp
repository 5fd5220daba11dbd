#include "oraclegs/render/cpu/tile_lists.h"

#include <algorithm>
#include <cstring>

#include "oraclegs/core/error.h"
#include "oraclegs/core/parallel.h"

namespace oraclegs::cpu {
namespace {

constexpr int kRadixBits = 11;
constexpr int kBuckets = 1 << kRadixBits;

// Sorting and dealing are stable, so the result does not depend on how the work is cut into chunks.
int64_t ChunkCount(int64_t items) { return std::clamp<int64_t>(items / 2048, 1, 4 * NumThreads()); }

template <class T>
void Grow(std::vector<T>* v, size_t size) {
  if (v->size() < size) v->resize(std::max(size, v->size() + v->size() / 2));
}

/// Turns counts[chunk][bucket] into start positions, buckets first, chunks second.
void PrefixByBucket(uint32_t* counts, int64_t chunks, int64_t buckets) {
  uint32_t sum = 0;
  for (int64_t b = 0; b < buckets; ++b) {
    for (int64_t c = 0; c < chunks; ++c) {
      const uint32_t count = counts[c * buckets + b];
      counts[c * buckets + b] = sum;
      sum += count;
    }
  }
}

}  // namespace

void TileLists::SortByDepth(const Splat* splats, const TileRect* rects, int64_t n) {
  Grow(&keys_, n);
  int64_t visible = 0;
  for (int64_t i = 0; i < n; ++i) {
    if (rects[i].Count() == 0) continue;
    uint32_t bits;  // the bits of positive floats sort like the floats
    std::memcpy(&bits, &splats[i].depth, sizeof(bits));
    keys_[visible++] = {bits, static_cast<uint32_t>(i)};
  }
  Grow(&keys_swap_, visible);
  const int64_t chunks = ChunkCount(visible);
  Grow(&histogram_, chunks * kBuckets);
  for (int shift = 0; shift < 32; shift += kRadixBits) {
    ParallelFor(chunks, [&](int64_t c) {
      uint32_t* counts = histogram_.data() + c * kBuckets;
      std::fill_n(counts, kBuckets, 0);
      for (int64_t i = visible * c / chunks; i < visible * (c + 1) / chunks; ++i) {
        ++counts[keys_[i].depth_bits >> shift & (kBuckets - 1)];
      }
    });
    PrefixByBucket(histogram_.data(), chunks, kBuckets);
    ParallelFor(chunks, [&](int64_t c) {
      uint32_t* positions = histogram_.data() + c * kBuckets;
      for (int64_t i = visible * c / chunks; i < visible * (c + 1) / chunks; ++i) {
        keys_swap_[positions[keys_[i].depth_bits >> shift & (kBuckets - 1)]++] = keys_[i];
      }
    });
    keys_.swap(keys_swap_);
  }
  order.resize(visible);
  for (int64_t i = 0; i < visible; ++i) order[i] = keys_[i].id;
}

void TileLists::Build(const Splat* splats, const TileRect* rects, int64_t n, int tiles_x, int tiles_y) {
  SortByDepth(splats, rects, n);
  const int64_t visible = static_cast<int64_t>(order.size()), tiles = static_cast<int64_t>(tiles_x) * tiles_y;
  Grow(&candidate_begin_, visible + 1);
  candidate_begin_[0] = 0;
  for (int64_t i = 0; i < visible; ++i) candidate_begin_[i + 1] = candidate_begin_[i] + rects[order[i]].Count();
  const int64_t candidates = candidate_begin_[visible];
  if (candidates > UINT32_MAX) {
    throw RunError(
        "{} Gaussians cover {} tiles in one view, more than 2^32: lower --max-gaussians or raise --downscale", visible,
        candidates);
  }
  Grow(&local_entries_, candidates);
  Grow(&pair_tile, candidates);
  Grow(&pair_slot, candidates);
  Grow(&ranges, n);
  std::fill_n(ranges.begin(), n, PairRange{});

  // Each chunk of Gaussians finds its pairs and counts them by tile ...
  const int64_t chunks = ChunkCount(visible);
  Grow(&histogram_, chunks * tiles);
  ParallelFor(chunks, [&](int64_t c) {
    uint32_t* counts = histogram_.data() + c * tiles;
    std::fill_n(counts, tiles, 0);
    for (int64_t i = visible * c / chunks; i < visible * (c + 1) / chunks; ++i) {
      const uint32_t id = order[i];
      const int64_t begin = candidate_begin_[i];
      const int64_t count = CoveredTiles(splats[id], rects[id], id, tiles_x, &local_entries_[begin], &pair_tile[begin]);
      for (int64_t j = begin; j < begin + count; ++j) ++counts[pair_tile[j]];
      ranges[id] = {static_cast<uint32_t>(begin), static_cast<uint32_t>(count)};
    }
  });
  tile_begin.resize(tiles + 1);
  PrefixByBucket(histogram_.data(), chunks, tiles);
  // ... then deals them out, in depth order within each tile.
  std::copy_n(histogram_.begin(), tiles, tile_begin.begin());
  pairs = 0;
  for (int64_t i = 0; i < visible; ++i) pairs += ranges[order[i]].count;
  tile_begin[tiles] = pairs;
  Grow(&entries, pairs);
  ParallelFor(chunks, [&](int64_t c) {
    uint32_t* positions = histogram_.data() + c * tiles;
    for (int64_t i = visible * c / chunks; i < visible * (c + 1) / chunks; ++i) {
      const PairRange range = ranges[order[i]];
      for (uint32_t j = range.begin; j < range.begin + range.count; ++j) {
        const uint32_t slot = positions[pair_tile[j]]++;
        entries[slot] = local_entries_[j];
        pair_slot[j] = slot;
      }
    }
  });
}

}  // namespace oraclegs::cpu
