// Forward blending. One task a tile. The tile's list is read near to far in segments; each 4 x 4 block walks the
// positions that reach it with its 16 pixels in vector lanes, and is done when every pixel is opaque.
// Kept for backward: final transmittance and where the pixel became opaque, 8 bytes a pixel. Nothing is allocated.

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "oraclegs/render/cpu/blend_forward.cpp"
#include "oraclegs/render/cpu/hwy_targets.h"
// clang-format off: foreach_target must come before the other Highway headers
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/highway.h>

#include <algorithm>

#include "oraclegs/render/cpu/falloff-inl.h"
#include "oraclegs/render/cpu/kernels.h"

HWY_BEFORE_NAMESPACE();
namespace oraclegs::HWY_NAMESPACE {

/// Where a pixel that takes nothing more is moved to: no Gaussian reaches it, and its squares stay finite.
inline constexpr float kOutOfReach = 1e15f;

/// What a block's pixels have gathered so far.
struct HWY_ALIGN BlockState {
  float x[16];  ///< px from the tile's centre, or kOutOfReach
  float t[16], r[16], g[16], b[16], inv_z[16];
  int32_t end[16];  ///< as BlendImage::end
};

/// Blends the segment's splats of one block, positions counted from `first`. Returns how many it visited, negative
/// when no pixel takes anything more.
HWY_INLINE int BlendBlock(const Segment& segment, int block, int32_t first, BlockState* state) {
  const FloatTag d;
  const IntTag di;
  const BlockPixels pixels(block);
  FloatVec x[kVecs], t[kVecs], r[kVecs], g[kVecs], b[kVecs], z[kVecs];
  for (int v = 0; v < kVecs; ++v) {
    x[v] = hn::Load(d, state->x + v * kLanes);
    t[v] = hn::Load(d, state->t + v * kLanes);
    r[v] = hn::Load(d, state->r + v * kLanes);
    g[v] = hn::Load(d, state->g + v * kLanes);
    b[v] = hn::Load(d, state->b + v * kLanes);
    z[v] = hn::Load(d, state->inv_z + v * kLanes);
  }
  const int32_t* HWY_RESTRICT positions = segment.positions[block];
  const int count = segment.counts[block];
  bool open = true;
  int j = 0;
  for (; j < count && open; ++j) {
    const int i = positions[j];
    for (int v = 0; v < kVecs; ++v) {
      FloatVec alpha = segment.Alpha(i, x[v], pixels.y[v]);
      FloatVec next = hn::NegMulAdd(alpha, t[v], t[v]);
      // Holds once in a pixel's life: what it needs stays out of the usual path.
      const FloatMask ends = hn::Lt(next, hn::Set(d, kTransmittanceEnd));
      if (HWY_UNLIKELY(!hn::AllFalse(d, ends))) {
        alpha = hn::IfThenZeroElse(ends, alpha);
        next = hn::IfThenElse(ends, t[v], next);
        x[v] = hn::IfThenElse(ends, hn::Set(d, kOutOfReach), x[v]);
        hn::BlendedStore(hn::Set(di, first + i), hn::RebindMask(di, ends), di, state->end + v * kLanes);
        open = false;
        for (int w = 0; w < kVecs; ++w) open |= !hn::AllFalse(d, hn::Lt(x[w], hn::Set(d, kOutOfReach)));
      }
      const FloatVec weight = hn::Mul(alpha, t[v]);
      t[v] = next;
      r[v] = hn::MulAdd(weight, hn::Set(d, segment.r[i]), r[v]);
      g[v] = hn::MulAdd(weight, hn::Set(d, segment.g[i]), g[v]);
      b[v] = hn::MulAdd(weight, hn::Set(d, segment.b[i]), b[v]);
      z[v] = hn::MulAdd(weight, hn::Set(d, segment.inv_z[i]), z[v]);
    }
  }
  for (int v = 0; v < kVecs; ++v) {
    hn::Store(x[v], d, state->x + v * kLanes);
    hn::Store(t[v], d, state->t + v * kLanes);
    hn::Store(r[v], d, state->r + v * kLanes);
    hn::Store(g[v], d, state->g + v * kLanes);
    hn::Store(b[v], d, state->b + v * kLanes);
    hn::Store(z[v], d, state->inv_z + v * kLanes);
  }
  return open ? j : -j;
}

HWY_INLINE void StartBlock(const cpu::TileWork& tile, int block, const cpu::BlendImage& out, BlockState* s) {
  const FloatTag d;
  const BlockPixels pixels(block);
  for (int v = 0; v < kVecs; ++v) hn::Store(pixels.x[v], d, s->x + v * kLanes);
  const int x0 = BlockX(tile, block), y0 = BlockY(tile, block);
  for (int i = 0; i < 16; ++i) {
    if (x0 + i % cpu::kBlock >= out.width || y0 + i / cpu::kBlock >= out.height) s->x[i] = kOutOfReach;
    s->t[i] = 1;
    s->r[i] = s->g[i] = s->b[i] = s->inv_z[i] = 0;
    s->end[i] = static_cast<int32_t>(tile.count);
  }
}

/// Writes a block's pixels that lie inside the image.
HWY_INLINE void StoreBlock(const BlockState& s, int x0, int y0, const cpu::BlendImage& out) {
  const int columns = std::min(cpu::kBlock, out.width - x0), rows = std::min(cpu::kBlock, out.height - y0);
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      const int i = y * cpu::kBlock + x;
      const int64_t pixel = static_cast<int64_t>(y0 + y) * out.width + x0 + x;
      out.image[3 * pixel] = s.r[i] + s.t[i] * out.background[0];
      out.image[3 * pixel + 1] = s.g[i] + s.t[i] * out.background[1];
      out.image[3 * pixel + 2] = s.b[i] + s.t[i] * out.background[2];
      out.alpha[pixel] = 1 - s.t[i];
      out.inv_depth[pixel] = s.inv_z[i];
    }
  }
}

HWY_NOINLINE int64_t BlendTile(const cpu::TileWork& tile, const cpu::BlendImage& out) {
  BlockState states[cpu::kBlocksPerTile];
  uint32_t open = 0;
  for (int block = 0; block < cpu::kBlocksPerTile; ++block) {
    const int x0 = BlockX(tile, block), y0 = BlockY(tile, block);
    StartBlock(tile, block, out, &states[block]);
    if (x0 < out.width && y0 < out.height) open |= 1u << block;
  }
  const uint32_t inside = open;
  Segment segment;
  int64_t visited = 0;
  for (int64_t begin = 0; begin < tile.count && open != 0; begin += Segment::kSize) {
    const int n = static_cast<int>(std::min<int64_t>(Segment::kSize, tile.count - begin));
    segment.Fill(tile, begin, n, open);
    for (uint32_t left = open; left != 0; left &= left - 1) {
      const int block = __builtin_ctz(left);
      const int steps = BlendBlock(segment, block, static_cast<int32_t>(begin), &states[block]);
      if (steps < 0) open &= ~(1u << block);
      visited += std::abs(steps);
    }
  }
  for (uint32_t left = inside; left != 0; left &= left - 1) {
    const int block = __builtin_ctz(left);
    StoreBlock(states[block], BlockX(tile, block), BlockY(tile, block), out);
  }
  if (out.transmittance != nullptr) {
    for (int block = 0; block < cpu::kBlocksPerTile; ++block) {
      const int64_t offset = tile.index * cpu::kTilePixels + block * 16;
      std::copy_n(states[block].t, 16, out.transmittance + offset);
      std::copy_n(states[block].end, 16, out.end + offset);
    }
  }
  return visited * 16;
}

}  // namespace oraclegs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace oraclegs {
HWY_EXPORT(BlendTile);

namespace cpu {
int64_t BlendTile(const TileWork& tile, const BlendImage& out) {
  return HWY_DYNAMIC_DISPATCH(oraclegs::BlendTile)(tile, out);
}
}  // namespace cpu
}  // namespace oraclegs
#endif
