#include "oraclegs/render/cuda/tile_pairs.h"

#include "oraclegs/render/cuda/falloff-inl.cuh"

namespace oraclegs::cuda {
namespace {

/// Gaussians of more tiles than this are worked on by the whole warp.
constexpr int kMaxTilesPerThread = 8;
constexpr uint32_t kUnseen = 0xffffffffu;  // as a depth: later than all
constexpr int kCountBlock = 256;

/// A Gaussian and the tiles it may reach.
struct Candidate {
  Reach reach{};
  int x0 = 0, y0 = 0, columns = 0, count = 0;

  __device__ bool Hits(int tile) const { return ReachesTile(reach, X(tile), Y(tile)); }
  __device__ int X(int tile) const { return x0 + tile % columns; }
  __device__ int Y(int tile) const { return y0 + tile / columns; }
};

__device__ inline Candidate LoadCandidate(const Splat* splats, const TileRect* rects, int64_t i) {
  const TileRect rect = rects[i];
  Candidate c;
  c.x0 = rect.x0, c.y0 = rect.y0;
  c.columns = rect.x1 - rect.x0;
  c.count = c.columns * (rect.y1 - rect.y0);
  if (c.count > 0) c.reach = ReachOf(splats[i]);
  return c;
}

/// The candidate of lane `from`, for all lanes.
__device__ inline Candidate Broadcast(const Candidate& c, int from) {
  const auto broadcast = [from](auto value) { return __shfl_sync(kAllLanes, value, from); };
  Candidate out;
  out.reach = {broadcast(c.reach.mx),    broadcast(c.reach.my),     broadcast(c.reach.ax),   broadcast(c.reach.by),
               broadcast(c.reach.slope), broadcast(c.reach.across), broadcast(c.reach.bound)};
  out.x0 = broadcast(c.x0), out.y0 = broadcast(c.y0), out.columns = broadcast(c.columns),
  out.count = broadcast(c.count);
  return out;
}

__global__ void CountKernel(const Splat* splats, const TileRect* rects, int64_t n, TileCountOutput out) {
  const int64_t i = ThreadInGrid();
  const int lane = LaneInWarp();
  Candidate mine;
  if (i < n) mine = LoadCandidate(splats, rects, i);
  unsigned count = 0;
  if (mine.count <= kMaxTilesPerThread) {
    for (int tile = 0; tile < mine.count; ++tile) count += mine.Hits(tile);
  }
  for (unsigned left = __ballot_sync(kAllLanes, mine.count > kMaxTilesPerThread); left != 0; left &= left - 1) {
    const int from = __ffs(static_cast<int>(left)) - 1;
    const Candidate c = Broadcast(mine, from);
    unsigned part = 0;
    for (int tile = lane; tile < c.count; tile += kWarp) part += c.Hits(tile);
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

__global__ void ListKernel(PairInput in, PairOutput out) {
  const int64_t r = ThreadInGrid();
  const int lane = LaneInWarp();
  Candidate mine;
  uint32_t id = 0, offset = 0;
  if (r < in.n) {
    id = in.ids[r];
    offset = in.offsets[r];
    mine = LoadCandidate(in.splats, in.rects, id);
    out.begins[id] = offset;
  }
  if (mine.count <= kMaxTilesPerThread) {
    int64_t pair = offset;
    for (int tile = 0; tile < mine.count; ++tile) {
      if (mine.Hits(tile)) WritePair(out, pair++, static_cast<uint32_t>(mine.Y(tile) * in.tiles_x + mine.X(tile)), id);
    }
  }
  for (unsigned left = __ballot_sync(kAllLanes, mine.count > kMaxTilesPerThread); left != 0; left &= left - 1) {
    const int from = __ffs(static_cast<int>(left)) - 1;
    const Candidate c = Broadcast(mine, from);
    const uint32_t owner = __shfl_sync(kAllLanes, id, from);
    int64_t pair = __shfl_sync(kAllLanes, offset, from);
    for (int first = 0; first < c.count; first += kWarp) {
      const int tile = first + lane;
      const bool hit = tile < c.count && c.Hits(tile);
      const unsigned hits = __ballot_sync(kAllLanes, hit);
      if (hit) {
        const int before = __popc(hits & ((1u << lane) - 1));
        WritePair(out, pair + before, static_cast<uint32_t>(c.Y(tile) * in.tiles_x + c.X(tile)), owner);
      }
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
  Launch("tile pairs", ListKernel, LaunchShape::For(in.n), stream, in, out);
}

void FindTileRanges(const RangeInput& in, TileRange* ranges, uint32_t* entry_ids, cudaStream_t stream) {
  Launch("tile ranges", RangesKernel, LaunchShape::For(in.pairs), stream, in, ranges, entry_ids);
}

}  // namespace oraclegs::cuda
