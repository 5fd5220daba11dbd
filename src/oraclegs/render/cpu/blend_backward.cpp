// Backward blending, tile by tile, blocks as in forward, the list far to near from where the last pixel ended.
//
// Let v = g_C . c + g_D / z of a Gaussian, and s that of everything behind it (background and alpha's gradient
// included). Then dL/d(alpha) = T (v - s): one running number a pixel instead of a color. The results are sums over the
// block's pixels of h = alpha dL/d(alpha) and w = alpha T against fixed numbers a pixel. A chunk of a block's list is
// processed in three sweeps:
//  1. near to far: alpha and w, with T counted from the chunk's near end. One division a pixel and chunk gives the T
//     it began with from the one it ended with, where a walk far to near would divide by 1 - alpha at every step.
//  2. far to near: s and h. The T at the chunk's near end is inside the upstream gradients, not in w.
//  3. rows of pixels become lanes of Gaussians (pixel_sums-inl.h), so that a sum over the block's pixels is a chain of
//     additions for as many Gaussians as there are lanes.
// No horizontal reduction, no atomics: each (tile, Gaussian) pair has its own record.

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "oraclegs/render/cpu/blend_backward.cpp"
#include "oraclegs/core/hwy_targets.h"
// clang-format off: foreach_target must come before the other Highway headers
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cstring>

#include "oraclegs/render/cpu/blocks-inl.h"
#include "oraclegs/render/cpu/falloff-inl.h"
#include "oraclegs/render/cpu/kernels.h"
#include "oraclegs/render/cpu/pixel_sums-inl.h"

HWY_BEFORE_NAMESPACE();
namespace oraclegs::HWY_NAMESPACE {

/// A block's running state and its pixels' upstream gradients.
struct HWY_ALIGN BlockAdjoint {
  float t[16];                ///< transmittance behind the current Gaussian
  float rest[16];             ///< s behind the current Gaussian
  float g[4][16];             ///< d/d(red), green, blue, inverse depth
  int32_t end[16];            ///< as BlendImage::end
  int32_t farthest, nearest;  ///< largest and smallest of end
};

/// Rows that the sweeps over a chunk hand to each other, one per Gaussian.
struct HWY_ALIGN Chunk {
  static constexpr int kSize = 64;
  float alpha[kSize][16];   ///< alpha; h after sweep 2
  float weight[kSize][16];  ///< w, with T = 1 at the chunk's near end
  float g[4][16];           ///< upstream gradients times the T at the chunk's near end
};

/// A number for each pixel of a block.
struct BlockVector {
  FloatVec v[kVecs];
};

/// A block and, for each pixel, the first step that does not contribute to it.
struct OpenPixels {
  int block;
  const IntVec* end;
};

/// Neighboring steps of a block's list.
struct Steps {
  int first, count;
};

/// Rows [begin, end) of a chunk.
struct ChunkRows {
  int begin, end;
};

/// Sweep 1 over positions[0, steps.count). Returns the fraction of the light that passes the chunk.
template <bool kAllSeen>
HWY_INLINE BlockVector SweepNearToFar(const Segment& segment, const int32_t* HWY_RESTRICT positions, const Steps& steps,
                                      const OpenPixels& pixels, Chunk* chunk) {
  const FloatTag d;
  const BlockPixels at(pixels.block);
  BlockVector t;
  for (int v = 0; v < kVecs; ++v) t.v[v] = hn::Set(d, 1.f);
  // A few steps at a time, as in forward: the chain to alpha is long and must not delay the one from T to T.
  constexpr int kSteps = 8;
  for (int start = 0; start < steps.count; start += kSteps) {
    const int stop = std::min(start + kSteps, steps.count);
    for (int j = start; j < stop; ++j) {
      FloatVec alpha[kVecs];
      if constexpr (kAllSeen) {
        segment.Alphas(positions[j], at, alpha);
      } else {
        FloatMask before_end[kVecs];
        for (int v = 0; v < kVecs; ++v) {
          before_end[v] = hn::RebindMask(d, hn::Gt(pixels.end[v], hn::Set(IntTag(), steps.first + j)));
        }
        segment.AlphasWhere(before_end, positions[j], at, alpha);
      }
      for (int v = 0; v < kVecs; ++v) hn::Store(alpha[v], d, chunk->alpha[j] + v * kLanes);
    }
    for (int j = start; j < stop; ++j) {
      for (int v = 0; v < kVecs; ++v) {
        const FloatVec alpha = hn::Load(d, chunk->alpha[j] + v * kLanes);
        hn::Store(hn::Mul(alpha, t.v[v]), d, chunk->weight[j] + v * kLanes);
        t.v[v] = hn::NegMulAdd(alpha, t.v[v], t.v[v]);
      }
    }
  }
  return t;
}

/// Sweep 2. `rest` is s times the T at the chunk's near end.
template <bool kDepth>
HWY_INLINE void SweepFarToNear(const Segment& segment, const int32_t* HWY_RESTRICT positions, const ChunkRows& rows,
                               Chunk* chunk, FloatVec* rest) {
  const FloatTag d;
  FloatVec g[4][kVecs];
  for (int c = 0; c < 3 + kDepth; ++c) {
    for (int v = 0; v < kVecs; ++v) g[c][v] = hn::Load(d, chunk->g[c] + v * kLanes);
  }
  for (int j = rows.end - 1; j >= rows.begin; --j) {
    const int i = positions[j];
    for (int v = 0; v < kVecs; ++v) {
      const FloatVec alpha = hn::Load(d, chunk->alpha[j] + v * kLanes);
      FloatVec value = hn::Mul(g[0][v], hn::Set(d, segment.r[i]));
      value = hn::MulAdd(g[1][v], hn::Set(d, segment.g[i]), value);
      value = hn::MulAdd(g[2][v], hn::Set(d, segment.b[i]), value);
      if constexpr (kDepth) value = hn::MulAdd(g[3][v], hn::Set(d, segment.inv_z[i]), value);
      const FloatVec difference = hn::Sub(value, rest[v]);
      // One multiply-add per step: more work than adding alpha times the difference to rest, but half the latency.
      rest[v] = hn::MulAdd(hn::Sub(hn::Set(d, 1.f), alpha), rest[v], hn::Mul(alpha, value));
      const FloatVec h = hn::Mul(hn::Load(d, chunk->weight[j] + v * kLanes), difference);
      // Capped alpha does not move with the Gaussian.
      hn::Store(hn::IfThenElseZero(hn::Lt(alpha, hn::Set(d, kAlphaMax)), h), d, chunk->alpha[j] + v * kLanes);
    }
  }
}

/// Sweep 3 over at most kLanes rows: adds to the records of their positions.
template <bool kDepth>
HWY_INLINE void SumOverPixels(const Chunk& chunk, const int32_t* HWY_RESTRICT positions, const ChunkRows& rows,
                              const BlockMiddle& middle, float* HWY_RESTRICT records) {
  FloatVec columns[cpu::kGradStride];
  for (const int unused : {6, 7, 11}) columns[unused] = hn::Zero(FloatTag());
  SumMoments(chunk.alpha + rows.begin, middle, columns);
  SumProducts<3 + kDepth>(chunk.weight + rows.begin, chunk.g, columns + 8);
  AddToRecords(columns, positions + rows.begin, rows.end - rows.begin, records);
}

/// Handles the segment's entries in one block's list. `first`: Segment::FirstStep; `records`: of the segment's first
/// entry. Returns the number of steps visited.
template <bool kDepth>
HWY_INLINE int BackwardBlock(const Segment& segment, int block, int32_t first, BlockAdjoint* state,
                             float* HWY_RESTRICT records) {
  const FloatTag d;
  const IntTag di;
  const int32_t* HWY_RESTRICT positions = segment.positions[block];
  IntVec end[kVecs];
  FloatVec t[kVecs], rest[kVecs];
  Chunk chunk;
  for (int v = 0; v < kVecs; ++v) {
    end[v] = hn::Sub(hn::Load(di, state->end + v * kLanes), hn::Set(di, first));
    t[v] = hn::Load(d, state->t + v * kLanes);
    rest[v] = hn::Load(d, state->rest + v * kLanes);
  }
  const int count = std::min(segment.counts[block], state->farthest - first);
  const BlockMiddle middle{static_cast<float>(block % 4 * cpu::kBlock + cpu::kBlock / 2 - kTile / 2),
                           static_cast<float>(block / 4 * cpu::kBlock + cpu::kBlock / 2 - kTile / 2)};
  for (int stop = count; stop > 0;) {
    // The chunks near the eye are full; a partial one costs nothing but its own vector.
    const int start = (stop - 1) / Chunk::kSize * Chunk::kSize;
    const int32_t* chunk_positions = positions + start;
    const int n = stop - start;
    const OpenPixels pixels{block, end};
    const BlockVector passed = stop <= state->nearest - first
                                   ? SweepNearToFar<true>(segment, chunk_positions, {start, n}, pixels, &chunk)
                                   : SweepNearToFar<false>(segment, chunk_positions, {start, n}, pixels, &chunk);
    for (int v = 0; v < kVecs; ++v) {
      t[v] = hn::Div(t[v], passed.v[v]);
      rest[v] = hn::Mul(rest[v], t[v]);
      for (int c = 0; c < 3 + kDepth; ++c) {
        hn::Store(hn::Mul(hn::Load(d, state->g[c] + v * kLanes), t[v]), d, chunk.g[c] + v * kLanes);
      }
    }
    // Alternating: the third sweep is bound by the shuffle unit, the second by the others.
    for (int end_row = n, row = (n - 1) / kLanes * kLanes; row >= 0; end_row = row, row -= kLanes) {
      SweepFarToNear<kDepth>(segment, chunk_positions, {row, end_row}, &chunk, rest);
      SumOverPixels<kDepth>(chunk, chunk_positions, {row, end_row}, middle, records);
    }
    for (int v = 0; v < kVecs; ++v) rest[v] = hn::Div(rest[v], t[v]);
    stop = start;
  }
  for (int v = 0; v < kVecs; ++v) {
    hn::Store(t[v], d, state->t + v * kLanes);
    hn::Store(rest[v], d, state->rest + v * kLanes);
  }
  return count;
}

/// The pixels of the upstream planes in one block.
struct HWY_ALIGN BlockUpstream {
  float rgb[48] = {}, alpha[16] = {}, inv_depth[16] = {};
};

HWY_INLINE void LoadUpstream(const UpstreamPlanes& up, const BlockPlace& place, BlockUpstream* block) {
  if (up.image != nullptr) CopyFromPlane<3>(up.image, place, block->rgb);
  if (up.alpha != nullptr) CopyFromPlane<1>(up.alpha, place, block->alpha);
  if (up.inv_depth != nullptr) CopyFromPlane<1>(up.inv_depth, place, block->inv_depth);
}

/// Starts a block. `offset`: the block's position in the forward pass's planes.
HWY_INLINE void StartBlock(const BlockUpstream& up, const cpu::BlendImage& forward, int64_t offset, BlockAdjoint* s) {
  const FloatTag d;
  const IntTag di;
  IntVec farthest = hn::Zero(di), nearest = hn::Set(di, INT32_MAX);
  for (int i = 0; i < 16; i += kLanes) {
    FloatVec g[4] = {{}, {}, {}, hn::Load(d, up.inv_depth + i)};
    hn::LoadInterleaved3(d, up.rgb + 3 * i, g[0], g[1], g[2]);
    for (int c = 0; c < 4; ++c) hn::Store(g[c], d, s->g[c] + i);
    FloatVec rest = hn::Neg(hn::Load(d, up.alpha + i));
    for (int c = 0; c < 3; ++c) rest = hn::MulAdd(g[c], hn::Set(d, forward.background[c]), rest);
    hn::Store(rest, d, s->rest + i);
    hn::Store(hn::LoadU(d, forward.transmittance + offset + i), d, s->t + i);
    const IntVec end = hn::LoadU(di, reinterpret_cast<const int32_t*>(forward.end) + offset + i);
    hn::Store(end, di, s->end + i);
    farthest = hn::Max(farthest, end);
    nearest = hn::Min(nearest, end);
  }
  s->farthest = hn::GetLane(hn::MaxOfLanes(di, farthest));
  s->nearest = hn::GetLane(hn::MinOfLanes(di, nearest));
}

/// Writes the records of entries [begin, end) to their places; `sums` null: zeros. The stores bypass the caches: the
/// places are scattered, and reading lines only to overwrite them would cost more than everything else.
HWY_INLINE void SendRecords(const cpu::TileWork& tile, int64_t begin, int64_t end, const float* sums, float* records) {
  const FloatTag d;
  for (int64_t i = begin; i < end; ++i) {
    float* record = records + static_cast<int64_t>(tile.entries[i].pair) * cpu::kGradStride;
    const float* from = sums == nullptr ? nullptr : sums + (i - begin) * cpu::kGradStride;
    for (int k = 0; k < cpu::kGradStride; k += kLanes) {
      hn::Stream(from == nullptr ? hn::Zero(d) : hn::Load(d, from + k), d, record + k);
    }
  }
  hwy::FlushStream();
}

/// Handles a whole tile. `farthest`: the maximum over its blocks.
template <bool kDepth>
HWY_INLINE int64_t BackwardTile(const cpu::TileWork& tile, BlockAdjoint* states, int32_t farthest, float* records) {
  if (farthest == 0) return 0;
  Segment segment;
  // Summed side by side in the first-level cache, then sent to their places.
  HWY_ALIGN float sums[Segment::kSize * cpu::kGradStride];
  int64_t visited = 0;
  for (int64_t begin = Segment::FirstEntry(farthest); begin >= 0; begin -= Segment::kSize) {
    const int n = static_cast<int>(std::min<int64_t>(Segment::kSize, tile.count - begin));
    const int32_t first = Segment::FirstStep(begin);
    uint32_t active = 0;
    for (int block = 0; block < cpu::kBlocksPerTile; ++block) {
      if (states[block].farthest > first) active |= 1u << block;
    }
    segment.Fill(tile, begin, n, active);
    std::memset(sums, 0, sizeof(float) * cpu::kGradStride * n);
    // The segment before; at the tile's first one, the next tile's last.
    const int64_t of_next =
        begin > 0 ? begin - Segment::kSize : (tile.next_count - 1) / Segment::kSize * Segment::kSize;
    const Upcoming upcoming =
        begin > 0 ? Upcoming{tile.splats, tile.entries + of_next, Segment::kSize}
                  : Upcoming{tile.splats, tile.entries + tile.count + of_next, tile.next_count - of_next};
    for (uint32_t left = active; left != 0; left &= left - 1) {
      const int block = __builtin_ctz(left);
      upcoming.Prefetch(block);
      visited += BackwardBlock<kDepth>(segment, block, first, &states[block], sums);
    }
    SendRecords(tile, begin, begin + n, sums, records);
  }
  return visited * 16;
}

HWY_NOINLINE int64_t BlendTileBackward(const cpu::TileWork& tile, const cpu::BlendImage& forward,
                                       const UpstreamPlanes& upstream, float* records) {
  if (tile.count == 0) return 0;
  BlockAdjoint states[cpu::kBlocksPerTile];
  BlockUpstream planes[cpu::kBlocksPerTile];
  uint32_t inside = 0;
  for (int block = 0; block < cpu::kBlocksPerTile; ++block) {
    const BlockPlace place(tile, block, forward.width, forward.height);
    if (place.Empty()) continue;
    inside |= 1u << block;
    LoadUpstream(upstream, place, &planes[block]);
  }
  int32_t farthest = 0;
  for (int block = 0; block < cpu::kBlocksPerTile; ++block) {  // not above: see the two loops of the forward pass
    states[block].farthest = 0;
    if (!(inside >> block & 1)) continue;
    StartBlock(planes[block], forward, tile.index * kTilePixels + block * 16, &states[block]);
    farthest = std::max(farthest, states[block].farthest);
  }
  SendRecords(tile, farthest == 0 ? 0 : Segment::FirstEntry(farthest) + Segment::kSize, tile.count, nullptr, records);
  return upstream.inv_depth != nullptr ? BackwardTile<true>(tile, states, farthest, records)
                                       : BackwardTile<false>(tile, states, farthest, records);
}

}  // namespace oraclegs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace oraclegs {
HWY_EXPORT(BlendTileBackward);

namespace cpu {
int64_t BlendTileBackward(const TileWork& tile, const BlendImage& forward, const UpstreamPlanes& upstream,
                          float* records) {
  return HWY_DYNAMIC_DISPATCH(BlendTileBackward)(tile, forward, upstream, records);
}
}  // namespace cpu
}  // namespace oraclegs
#endif
