// Binning: cover (the tiles that each Gaussian reaches), one radix sort of the visible by depth, then a scatter of the
// pairs to their tiles in that order. Every step is a counting step, a prefix sum and a stable scatter over chunks, so
// that the result does not depend on the partition.

#include "oraclegs/render/cpu/tile_lists.h"

#include <algorithm>
#include <cstring>

#include "oraclegs/core/error.h"
#include "oraclegs/core/parallel.h"

namespace oraclegs::cpu {
namespace {

constexpr int kRadixBits = 11;
constexpr int kBuckets = 1 << kRadixBits;
constexpr int64_t kPrefetch = 16;  // items ahead: what they point to lies anywhere in memory

/// More chunks than threads, so that a thread without a core delays little.
int64_t ChunkCount(int64_t items) { return std::clamp<int64_t>(items / 2048, 1, 4 * NumThreads()); }

int64_t ChunkBegin(int64_t items, int64_t chunk, int64_t chunks) { return items * chunk / chunks; }

/// Turns counts[chunk][bucket] into positions within the bucket and sets begin[bucket] to the bucket's start,
/// begin[buckets] to the total.
void PrefixSums(uint32_t* counts, int64_t chunks, int64_t buckets, int64_t* begin) {
  ParallelBlocks(buckets, 1024, [&](int64_t first, int64_t last) {
    std::fill(begin + first, begin + last, 0);
    for (int64_t c = 0; c < chunks; ++c) {
      uint32_t* row = counts + c * buckets;
      for (int64_t b = first; b < last; ++b) {
        const uint32_t count = row[b];
        row[b] = static_cast<uint32_t>(begin[b]);
        begin[b] += count;
      }
    }
  });
  int64_t sum = 0;
  for (int64_t b = 0; b < buckets; ++b) {
    const int64_t count = begin[b];
    begin[b] = sum;
    sum += count;
  }
  begin[buckets] = sum;
}

}  // namespace

void TileLists::Cover(const LineSplat* splats, const TileRect* rects, int64_t n, int tiles_x) {
  const int64_t chunks = ChunkCount(n);
  chunks_.resize(chunks);
  ParallelFor(chunks, [&](int64_t c) {
    int64_t sum = 0;
    for (int64_t i = ChunkBegin(n, c, chunks); i < ChunkBegin(n, c + 1, chunks); ++i) sum += rects[i].Count();
    chunks_[c].candidates = sum;
  });
  int64_t candidates = 0;
  for (Chunk& chunk : chunks_) {
    chunk.first_candidate = candidates;
    candidates += chunk.candidates;
  }
  if (candidates >= UINT32_MAX) {
    throw RunError(
        "{} Gaussians cover {} tiles in one view, more than 2^32: lower --max-gaussians or raise --downscale", n,
        candidates);
  }
  pair_numbers = candidates;
  pair_tile.Reserve(candidates);
  pair_mask_.Reserve(candidates);
  ranges.Reserve(n);
  sorted_.Reserve(n);
  ParallelFor(chunks, [&](int64_t c) {
    Chunk& chunk = chunks_[c];
    const int64_t begin = ChunkBegin(n, c, chunks), end = ChunkBegin(n, c + 1, chunks);
    const uint32_t first = static_cast<uint32_t>(chunk.first_candidate);
    const CoverOutput out{pair_tile.data(), pair_mask_.data(), ranges.data()};
    chunk.pairs = CoverTiles({splats, rects, tiles_x}, begin, end, first, out) - first;
    Key* keys = sorted_.data() + begin;
    int64_t count = 0;
    for (int64_t i = begin; i < end; ++i) {
      // The bits of positive floats sort like the floats. A key without pairs is overwritten by the next.
      std::memcpy(&keys[count].depth_bits, &splats[i].depth, sizeof(uint32_t));
      keys[count].id = static_cast<uint32_t>(i);
      count += ranges.data()[i].count != 0;
    }
    chunk.visible = count;
  });
  visible = pairs = 0;
  for (Chunk& chunk : chunks_) {
    chunk.first_visible = visible;
    visible += chunk.visible;
    pairs += chunk.pairs;
  }
  keys_.Reserve(visible);
  ParallelFor(chunks, [&](int64_t c) {
    std::copy_n(sorted_.data() + ChunkBegin(n, c, chunks), chunks_[c].visible, keys_.data() + chunks_[c].first_visible);
  });
}

void TileLists::SortByDepth() {
  const int64_t chunks = ChunkCount(visible);
  histogram_.Reserve(chunks * kBuckets);
  digit_begin_.Reserve(kBuckets + 1);
  sorted_.Reserve(visible);
  for (int shift = 0; shift < 32; shift += kRadixBits) {
    const auto digit = [shift](const Key& key) { return key.depth_bits >> shift & (kBuckets - 1); };
    const Key* keys = keys_.data();
    Key* sorted = sorted_.data();
    ParallelFor(chunks, [&](int64_t c) {
      uint32_t* counts = histogram_.data() + c * kBuckets;
      std::fill_n(counts, kBuckets, 0);
      const int64_t end = ChunkBegin(visible, c + 1, chunks);
      for (int64_t i = ChunkBegin(visible, c, chunks); i < end; ++i) ++counts[digit(keys[i])];
    });
    PrefixSums(histogram_.data(), chunks, kBuckets, digit_begin_.data());
    ParallelFor(chunks, [&](int64_t c) {
      uint32_t* positions = histogram_.data() + c * kBuckets;
      for (int64_t b = 0; b < kBuckets; ++b) positions[b] += static_cast<uint32_t>(digit_begin_.data()[b]);
      const int64_t end = ChunkBegin(visible, c + 1, chunks);
      for (int64_t i = ChunkBegin(visible, c, chunks); i < end; ++i) sorted[positions[digit(keys[i])]++] = keys[i];
    });
    std::swap(keys_, sorted_);
  }
}

void TileLists::ScatterToTiles(int64_t tiles) {
  const int64_t chunks = ChunkCount(visible);
  histogram_.Reserve(chunks * tiles);
  tile_begin.Reserve(tiles + 1);
  entries.Reserve(pairs);
  const Key* keys = keys_.data();
  const PairRange* range_of = ranges.data();
  const uint32_t *tile_of = pair_tile.data(), *mask_of = pair_mask_.data();
  ParallelFor(chunks, [&](int64_t c) {
    uint32_t* counts = histogram_.data() + c * tiles;
    std::fill_n(counts, tiles, 0);
    const int64_t end = ChunkBegin(visible, c + 1, chunks);
    for (int64_t i = ChunkBegin(visible, c, chunks); i < end; ++i) {
      if (i + 2 * kPrefetch < end) __builtin_prefetch(&range_of[keys[i + 2 * kPrefetch].id]);
      if (i + kPrefetch < end) __builtin_prefetch(&tile_of[range_of[keys[i + kPrefetch].id].begin]);
      const PairRange range = range_of[keys[i].id];
      for (uint32_t j = range.begin; j < range.begin + range.count; ++j) ++counts[tile_of[j]];
    }
  });
  PrefixSums(histogram_.data(), chunks, tiles, tile_begin.data());
  ParallelFor(chunks, [&](int64_t c) {
    uint32_t* positions = histogram_.data() + c * tiles;
    for (int64_t t = 0; t < tiles; ++t) positions[t] += static_cast<uint32_t>(tile_begin.data()[t]);
    const int64_t end = ChunkBegin(visible, c + 1, chunks);
    for (int64_t i = ChunkBegin(visible, c, chunks); i < end; ++i) {
      if (i + 2 * kPrefetch < end) __builtin_prefetch(&range_of[keys[i + 2 * kPrefetch].id]);
      if (i + kPrefetch < end) {
        const uint32_t next = range_of[keys[i + kPrefetch].id].begin;
        __builtin_prefetch(&tile_of[next]);
        __builtin_prefetch(&mask_of[next]);
      }
      const PairRange range = range_of[keys[i].id];
      for (uint32_t j = range.begin; j < range.begin + range.count; ++j) {
        entries.data()[positions[tile_of[j]]++] = {keys[i].id, mask_of[j], j};
      }
    }
  });
}

void TileLists::Build(const LineSplat* splats, const TileRect* rects, int64_t n, int tiles_x, int tiles_y) {
  Cover(splats, rects, n, tiles_x);
  SortByDepth();
  ScatterToTiles(static_cast<int64_t>(tiles_x) * tiles_y);
}

}  // namespace oraclegs::cpu
