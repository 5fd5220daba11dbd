// Binning: cover (which tiles does each Gaussian reach), one radix sort of the visible by depth, then pairs dealt to
// their tiles in that order. Every step is a counting step, a prefix sum and a stable scatter over chunks, so that the
// result does not depend on how the work is cut.

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

/// More chunks than threads, so that a thread without a core holds up little.
int64_t ChunkCount(int64_t items) { return std::clamp<int64_t>(items / 2048, 1, 4 * NumThreads()); }

int64_t ChunkBegin(int64_t items, int64_t chunk, int64_t chunks) { return items * chunk / chunks; }

template <class T>
void Grow(std::vector<T>* v, size_t size) {
  if (v->size() < size) v->resize(std::max(size, v->size() + v->size() / 2));
}

/// counts[chunk][bucket] become positions within the bucket; begin[bucket] the bucket's start, begin[buckets] the sum.
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

void TileLists::Cover(const Splat* splats, const TileRect* rects, int64_t n, int tiles_x) {
  const int64_t chunks = ChunkCount(n);
  Grow(&chunks_, chunks);
  ParallelFor(chunks, [&](int64_t c) {
    int64_t sum = 0;
    for (int64_t i = ChunkBegin(n, c, chunks); i < ChunkBegin(n, c + 1, chunks); ++i) sum += rects[i].Count();
    chunks_[c].candidates = sum;
  });
  int64_t candidates = 0;
  for (int64_t c = 0; c < chunks; ++c) {
    chunks_[c].first_candidate = candidates;
    candidates += chunks_[c].candidates;
  }
  if (candidates >= UINT32_MAX) {
    throw RunError(
        "{} Gaussians cover {} tiles in one view, more than 2^32: lower --max-gaussians or raise --downscale", n,
        candidates);
  }
  // One more: the kernel writes a pair before it knows whether it counts.
  Grow(&pair_tile, candidates + 1);
  Grow(&pair_slot, candidates + 1);
  Grow(&ranges, n);
  Grow(&keys_swap_, n);
  ParallelFor(chunks, [&](int64_t c) {
    Chunk& chunk = chunks_[c];
    const int64_t begin = ChunkBegin(n, c, chunks), end = ChunkBegin(n, c + 1, chunks);
    const uint32_t first = static_cast<uint32_t>(chunk.first_candidate);
    const CoverOutput out{pair_tile.data(), pair_slot.data(), ranges.data()};  // slots come later: masks first
    chunk.pairs = CoverTiles(splats, rects, begin, end, tiles_x, first, out) - first;
    Key* keys = keys_swap_.data() + begin;
    int64_t count = 0;
    for (int64_t i = begin; i < end; ++i) {
      // The bits of positive floats sort like the floats. What does not count is overwritten by the next.
      std::memcpy(&keys[count].depth_bits, &splats[i].depth, sizeof(uint32_t));
      keys[count].id = static_cast<uint32_t>(i);
      count += ranges[i].count != 0;
    }
    chunk.visible = count;
  });
  visible = pairs = 0;
  for (int64_t c = 0; c < chunks; ++c) {
    chunks_[c].first_visible = visible;
    visible += chunks_[c].visible;
    pairs += chunks_[c].pairs;
  }
  Grow(&keys_, visible);
  ParallelFor(chunks, [&](int64_t c) {
    std::copy_n(keys_swap_.begin() + ChunkBegin(n, c, chunks), chunks_[c].visible,
                keys_.begin() + chunks_[c].first_visible);
  });
}

void TileLists::SortByDepth() {
  const int64_t chunks = ChunkCount(visible);
  Grow(&histogram_, chunks * kBuckets);
  Grow(&digit_begin_, kBuckets + 1);
  for (int shift = 0; shift < 32; shift += kRadixBits) {
    const auto digit = [shift](const Key& key) { return key.depth_bits >> shift & (kBuckets - 1); };
    ParallelFor(chunks, [&](int64_t c) {
      uint32_t* counts = histogram_.data() + c * kBuckets;
      std::fill_n(counts, kBuckets, 0);
      const int64_t end = ChunkBegin(visible, c + 1, chunks);
      for (int64_t i = ChunkBegin(visible, c, chunks); i < end; ++i) ++counts[digit(keys_[i])];
    });
    PrefixSums(histogram_.data(), chunks, kBuckets, digit_begin_.data());
    ParallelFor(chunks, [&](int64_t c) {
      uint32_t* positions = histogram_.data() + c * kBuckets;
      for (int64_t b = 0; b < kBuckets; ++b) positions[b] += static_cast<uint32_t>(digit_begin_[b]);
      const int64_t end = ChunkBegin(visible, c + 1, chunks);
      for (int64_t i = ChunkBegin(visible, c, chunks); i < end; ++i)
        keys_swap_[positions[digit(keys_[i])]++] = keys_[i];
    });
    keys_.swap(keys_swap_);
  }
}

void TileLists::Deal(int64_t tiles) {
  const int64_t chunks = ChunkCount(visible);
  Grow(&histogram_, chunks * tiles);
  tile_begin.resize(tiles + 1);
  Grow(&entries, pairs);
  ParallelFor(chunks, [&](int64_t c) {
    uint32_t* counts = histogram_.data() + c * tiles;
    std::fill_n(counts, tiles, 0);
    const int64_t end = ChunkBegin(visible, c + 1, chunks);
    for (int64_t i = ChunkBegin(visible, c, chunks); i < end; ++i) {
      const PairRange range = ranges[keys_[i].id];
      if (i + kPrefetch < end) __builtin_prefetch(&pair_tile[ranges[keys_[i + kPrefetch].id].begin]);
      if (i + 2 * kPrefetch < end) __builtin_prefetch(&ranges[keys_[i + 2 * kPrefetch].id]);
      for (uint32_t j = range.begin; j < range.begin + range.count; ++j) ++counts[pair_tile[j]];
    }
  });
  PrefixSums(histogram_.data(), chunks, tiles, tile_begin.data());
  ParallelFor(chunks, [&](int64_t c) {
    uint32_t* positions = histogram_.data() + c * tiles;
    for (int64_t t = 0; t < tiles; ++t) positions[t] += static_cast<uint32_t>(tile_begin[t]);
    const int64_t end = ChunkBegin(visible, c + 1, chunks);
    for (int64_t i = ChunkBegin(visible, c, chunks); i < end; ++i) {
      const PairRange range = ranges[keys_[i].id];
      if (i + kPrefetch < end) {
        const uint32_t next = ranges[keys_[i + kPrefetch].id].begin;
        __builtin_prefetch(&pair_tile[next]);
        __builtin_prefetch(&pair_slot[next], 1);
      }
      for (uint32_t j = range.begin; j < range.begin + range.count; ++j) {
        const uint32_t slot = positions[pair_tile[j]]++;
        entries[slot] = {keys_[i].id, pair_slot[j]};
        pair_slot[j] = slot;
      }
    }
  });
}

void TileLists::Build(const Splat* splats, const TileRect* rects, int64_t n, int tiles_x, int tiles_y) {
  Cover(splats, rects, n, tiles_x);
  SortByDepth();
  Deal(static_cast<int64_t>(tiles_x) * tiles_y);
}

}  // namespace oraclegs::cpu
