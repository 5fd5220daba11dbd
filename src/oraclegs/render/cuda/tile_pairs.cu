#include "oraclegs/render/cuda/stages.h"

#include "oraclegs/render/cuda/falloff-inl.cuh"

namespace oraclegs::cuda {
namespace {

/// Tiles of a Gaussian above which the whole warp works on it.
constexpr int kMaxTilesPerThread = 8;
constexpr uint32_t kUnseen = 0xffffffffu;  // as a depth: later than all
constexpr int kCountBlock = 256;

/// A Gaussian and the tiles it may reach, row by row.
struct Candidate {
  Reach reach{};
  int x0 = 0, y0 = 0, columns = 0, count = 0;

  __device__ bool is_large() const { return count > kMaxTilesPerThread; }
};

/// Iterator over the tiles of a candidate: tile `at`, then each `stride`-th. Divides at the start only.
class Walk {
 public:
  __device__ Walk(const Candidate& c, int at, int stride)
      : c_(c),
        at_(at),
        stride_(stride),
        row_(at / c.columns),
        column_(at % c.columns),
        rows_a_step_(stride / c.columns),
        columns_a_step_(stride % c.columns) {}

  __device__ void Step() {
    at_ += stride_;
    row_ += rows_a_step_, column_ += columns_a_step_;
    if (column_ >= c_.columns) column_ -= c_.columns, ++row_;
  }
  __device__ int x() const { return c_.x0 + column_; }
  __device__ int y() const { return c_.y0 + row_; }
  __device__ bool Hits() const { return at_ < c_.count && ReachesTile(c_.reach, x(), y()); }

 private:
  const Candidate& c_;
  int at_, stride_, row_, column_, rows_a_step_, columns_a_step_;
};

__device__ inline Candidate TilesOf(const TileRect& rect) {
  Candidate c;
  c.x0 = rect.x0, c.y0 = rect.y0;
  c.columns = rect.x1 - rect.x0;
  c.count = c.columns * (rect.y1 - rect.y0);
  return c;
}

/// The candidate of lane `from`, for all lanes.
__device__ inline Candidate Broadcast(const Candidate& c, int from) {
  const auto broadcast = [from](auto value) { return __shfl_sync(kAllLanes, value, from); };
  Candidate out;
  const ReachTerms<float>& terms = c.reach.terms;
  out.reach = {broadcast(c.reach.mx),
               broadcast(c.reach.my),
               {broadcast(terms.ax), broadcast(terms.by), broadcast(terms.slope), broadcast(terms.across),
                broadcast(terms.bound)}};
  out.x0 = broadcast(c.x0), out.y0 = broadcast(c.y0), out.columns = broadcast(c.columns),
  out.count = broadcast(c.count);
  return out;
}

__global__ void CountKernel(const Splat* splats, const TileRect* rects, int64_t n, TileCountOutput out) {
  const int64_t i = ThreadInGrid();
  const int lane = LaneInWarp();
  Candidate mine;
  if (i < n) mine = TilesOf(rects[i]);
  if (mine.count > 0) mine.reach = ReachOf(splats[i]);
  unsigned count = 0;
  if (mine.count > 0 && !mine.is_large()) {
    Walk walk(mine, 0, 1);
    for (int k = 0; k < mine.count; ++k, walk.Step()) count += walk.Hits();
  }
  for (unsigned left = __ballot_sync(kAllLanes, mine.is_large()); left != 0; left &= left - 1) {
    const int from = __ffs(static_cast<int>(left)) - 1;
    const Candidate c = Broadcast(mine, from);
    unsigned part = 0;
    Walk walk(c, lane, kWarp);
    for (int k = 0; k < c.count; k += kWarp, walk.Step()) part += walk.Hits();
    part = WarpSum(part);
    if (lane == from) count = part;
  }
  if (i < n) {
    out.counts[i] = count;
    // The bits of positive floats sort like the floats.
    out.depth_keys[i] = count > 0 ? __float_as_uint(splats[i].depth) : kUnseen;
    out.ids[i] = static_cast<uint32_t>(i);
  }
  // Once a block: all blocks add to the same two numbers.
  __shared__ unsigned long long pairs_of_warps[kCountBlock / kWarp];
  const unsigned long long of_warp = WarpSum(static_cast<unsigned long long>(count));
  if (lane == 0) pairs_of_warps[threadIdx.x / kWarp] = of_warp;
  const int visible = __syncthreads_count(count > 0);
  if (threadIdx.x != 0 || visible == 0) return;
  unsigned long long pairs = 0;
  for (const unsigned long long part : pairs_of_warps) pairs += part;
  atomicAdd(&out.counters->visible, static_cast<unsigned long long>(visible));
  atomicAdd(&out.counters->pairs, pairs);
}

__global__ void GatherKernel(const uint32_t* counts, const uint32_t* ids, int64_t n, uint32_t* in_order) {
  const int64_t r = ThreadInGrid();
  if (r < n) in_order[r] = counts[ids[r]];
}

__device__ inline void WritePair(const PairOutput& out, int64_t pair, uint32_t tile, uint32_t id) {
  if (pair >= out.capacity) return;
  out.tiles[pair] = tile;
  out.numbers[pair] = static_cast<uint32_t>(pair);
  out.gaussians[pair] = id;
}

__device__ inline uint32_t TileNumber(const PairInput& in, const Walk& walk) {
  return static_cast<uint32_t>(walk.y() * in.tiles_x + walk.x());
}

/// The Gaussian of rank `r`, unless it is of the other kind (large or small).
struct Ranked {
  Candidate candidate;
  uint32_t id = 0;
  int64_t first_pair = 0;
};
__device__ inline Ranked LoadRanked(const PairInput& in, int64_t r, bool large) {
  Ranked ranked;
  if (r >= in.n) return ranked;
  const uint32_t id = in.ids[r];
  const Candidate c = TilesOf(in.rects[id]);
  if (c.count == 0 || c.is_large() != large) return ranked;
  ranked = {c, id, in.offsets[r]};
  ranked.candidate.reach = ReachOf(in.splats[id]);
  return ranked;
}

/// Lists pairs: the first half of the blocks large Gaussians, a warp each; the other half small ones, a thread each.
/// Gaussians near the eye, which fill the image, are neighbors in the order of depth: a warp takes ranks that lie far
/// apart, so that no warp has them all.
__global__ void ListKernel(PairInput in, PairOutput out) {
  const int64_t half = gridDim.x / 2;
  const int lane = LaneInWarp();
  if (blockIdx.x >= half) {
    const int64_t r = ThreadInGrid() - half * blockDim.x;
    const Ranked mine = LoadRanked(in, r, false);
    if (mine.candidate.count > 0) {
      out.begins[mine.id] = static_cast<uint32_t>(mine.first_pair);
      int64_t pair = mine.first_pair;
      Walk walk(mine.candidate, 0, 1);
      for (int k = 0; k < mine.candidate.count; ++k, walk.Step()) {
        if (walk.Hits()) WritePair(out, pair++, TileNumber(in, walk), mine.id);
      }
    }
    return;
  }
  const int64_t warps = half * blockDim.x / kWarp;
  const Ranked mine = LoadRanked(in, lane * warps + ThreadInGrid() / kWarp, true);
  if (mine.candidate.count > 0) out.begins[mine.id] = static_cast<uint32_t>(mine.first_pair);
  for (unsigned left = __ballot_sync(kAllLanes, mine.candidate.count > 0); left != 0; left &= left - 1) {
    const int from = __ffs(static_cast<int>(left)) - 1;
    const Candidate c = Broadcast(mine.candidate, from);
    const uint32_t owner = __shfl_sync(kAllLanes, mine.id, from);
    int64_t pair = __shfl_sync(kAllLanes, mine.first_pair, from);
    Walk walk(c, lane, kWarp);
    for (int k = 0; k < c.count; k += kWarp, walk.Step()) {
      const bool hit = walk.Hits();
      const unsigned hits = __ballot_sync(kAllLanes, hit);
      if (hit) WritePair(out, pair + __popc(hits & ((1u << lane) - 1)), TileNumber(in, walk), owner);
      pair += __popc(hits);
    }
  }
}

__global__ void RangesKernel(RangeInput in, TileRange* ranges, uint32_t* entry_ids) {
  const int64_t i = ThreadInGrid();
  if (i >= in.pairs) return;
  const uint32_t tile = in.sorted_tiles[i], before = i > 0 ? in.sorted_tiles[i - 1] : kUnseen;
  if (before != tile) {
    if (tile < in.tiles) ranges[tile].begin = static_cast<uint32_t>(i);
    if (before < in.tiles) ranges[before].end = static_cast<uint32_t>(i);
  }
  if (tile >= in.tiles) return;
  entry_ids[i] = in.gaussians[in.sorted_numbers[i]];
  if (i + 1 == in.pairs) ranges[tile].end = static_cast<uint32_t>(in.pairs);
}

}  // namespace

void CountTiles(const Splat* splats, const TileRect* rects, int64_t n, const TileCountOutput& out,
                cudaStream_t stream) {
  Launch("tile counting", CountKernel, LaunchShape::For(n, kCountBlock), stream, splats, rects, n, out);
}

void GatherCounts(const uint32_t* counts, const uint32_t* ids, int64_t n, uint32_t* in_order, cudaStream_t stream) {
  Launch("tile counts by depth", GatherKernel, LaunchShape::For(n), stream, counts, ids, n, in_order);
}

void ListPairs(const PairInput& in, const PairOutput& out, cudaStream_t stream) {
  LaunchShape shape = LaunchShape::For(in.n);
  shape.blocks *= 2;
  Launch("tile pairs", ListKernel, shape, stream, in, out);
}

void FindTileRanges(const RangeInput& in, TileRange* ranges, uint32_t* entry_ids, cudaStream_t stream) {
  Launch("tile ranges", RangesKernel, LaunchShape::For(in.pairs), stream, in, ranges, entry_ids);
}

}  // namespace oraclegs::cuda
