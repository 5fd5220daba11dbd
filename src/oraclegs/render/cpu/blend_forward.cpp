// Forward blending. One task a tile. The tile's list is read near to far in segments; each 4 x 4 block walks the
// positions that reach it with its 16 pixels in vector lanes, and is done when every pixel is opaque.
// Kept for backward: final transmittance and last contributor, 8 bytes a pixel. Nothing is allocated.

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

/// What a block's pixels have gathered so far.
struct HWY_ALIGN BlockState {
  float t[16], r[16], g[16], b[16], inv_z[16];
  int32_t last[16];
  float alive[16];  ///< 1, or 0 once opaque or when outside the image
};

/// Blends the segment's splats of one block. Returns whether a pixel is still open.
HWY_INLINE bool BlendBlock(const Segment& segment, int block, int32_t first, BlockState* state) {
  const FloatTag d;
  const IntTag di;
  const BlockPixels pixels(block);
  FloatVec t[kVecs], r[kVecs], g[kVecs], b[kVecs], z[kVecs];
  IntVec last[kVecs];
  FloatMask alive[kVecs];
  for (int v = 0; v < kVecs; ++v) {
    t[v] = hn::Load(d, state->t + v * kLanes);
    r[v] = hn::Load(d, state->r + v * kLanes);
    g[v] = hn::Load(d, state->g + v * kLanes);
    b[v] = hn::Load(d, state->b + v * kLanes);
    z[v] = hn::Load(d, state->inv_z + v * kLanes);
    last[v] = hn::Load(di, state->last + v * kLanes);
    alive[v] = hn::Ne(hn::Load(d, state->alive + v * kLanes), hn::Zero(d));
  }
  const uint16_t* HWY_RESTRICT positions = segment.positions[block];
  const int count = segment.counts[block];
  bool open = true;
  for (int j = 0; j < count && open; ++j) {
    const cpu::Splat& s = segment.splats[positions[j]];
    const IntVec position = hn::Set(di, first + positions[j] + 1);
    open = false;
    for (int v = 0; v < kVecs; ++v) {
      const Coverage c = Cover(s, pixels.x[v], pixels.y[v]);
      const FloatMask hit = hn::And(c.covered, alive[v]);
      const FloatVec weight = hn::Mul(c.alpha, t[v]);
      const FloatVec next = hn::NegMulAdd(c.alpha, t[v], t[v]);
      const FloatMask ends = hn::And(hit, hn::Lt(next, hn::Set(d, kTransmittanceEnd)));
      const FloatMask adds = hn::AndNot(ends, hit);
      alive[v] = hn::AndNot(ends, alive[v]);
      const FloatVec w = hn::IfThenElseZero(adds, weight);
      r[v] = hn::MulAdd(w, hn::Set(d, s.r), r[v]);
      g[v] = hn::MulAdd(w, hn::Set(d, s.g), g[v]);
      b[v] = hn::MulAdd(w, hn::Set(d, s.b), b[v]);
      z[v] = hn::MulAdd(w, hn::Set(d, s.inv_z), z[v]);
      t[v] = hn::IfThenElse(adds, next, t[v]);
      last[v] = hn::IfThenElse(hn::RebindMask(di, adds), position, last[v]);
      open |= !hn::AllFalse(d, alive[v]);
    }
  }
  for (int v = 0; v < kVecs; ++v) {
    hn::Store(t[v], d, state->t + v * kLanes);
    hn::Store(r[v], d, state->r + v * kLanes);
    hn::Store(g[v], d, state->g + v * kLanes);
    hn::Store(b[v], d, state->b + v * kLanes);
    hn::Store(z[v], d, state->inv_z + v * kLanes);
    hn::Store(last[v], di, state->last + v * kLanes);
    hn::Store(hn::IfThenElseZero(alive[v], hn::Set(d, 1.f)), d, state->alive + v * kLanes);
  }
  return open;
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

HWY_NOINLINE void BlendTile(const cpu::Splat* splats, const cpu::TileEntry* entries, int64_t count, int tile_x,
                            int tile_y, int64_t tile, const cpu::BlendImage& out) {
  BlockState states[cpu::kBlocksPerTile];
  uint32_t open = 0;
  for (int block = 0; block < cpu::kBlocksPerTile; ++block) {
    const int x0 = tile_x * cpu::kTile + block % 4 * cpu::kBlock, y0 = tile_y * cpu::kTile + block / 4 * cpu::kBlock;
    BlockState& s = states[block];
    for (int i = 0; i < 16; ++i) {
      s.t[i] = 1;
      s.r[i] = s.g[i] = s.b[i] = s.inv_z[i] = 0;
      s.last[i] = 0;
      s.alive[i] = x0 + i % 4 < out.width && y0 + i / 4 < out.height ? 1.f : 0.f;
    }
    if (x0 < out.width && y0 < out.height) open |= 1u << block;
  }
  const float center_x = static_cast<float>(tile_x * cpu::kTile + cpu::kTile / 2);
  const float center_y = static_cast<float>(tile_y * cpu::kTile + cpu::kTile / 2);
  Segment segment;
  for (int64_t begin = 0; begin < count && open != 0; begin += Segment::kSize) {
    const int n = static_cast<int>(std::min<int64_t>(Segment::kSize, count - begin));
    segment.Fill(splats, entries + begin, n, center_x, center_y, open);
    for (uint32_t left = open; left != 0; left &= left - 1) {
      const int block = __builtin_ctz(left);
      if (!BlendBlock(segment, block, static_cast<int32_t>(begin), &states[block])) open &= ~(1u << block);
    }
  }
  for (int block = 0; block < cpu::kBlocksPerTile; ++block) {
    const int x0 = tile_x * cpu::kTile + block % 4 * cpu::kBlock, y0 = tile_y * cpu::kTile + block / 4 * cpu::kBlock;
    StoreBlock(states[block], x0, y0, out);
    if (out.transmittance == nullptr) continue;
    const int64_t offset = tile * cpu::kTilePixels + block * 16;
    std::copy_n(states[block].t, 16, out.transmittance + offset);
    std::copy_n(states[block].last, 16, out.last + offset);
  }
}

}  // namespace oraclegs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace oraclegs {
HWY_EXPORT(BlendTile);

namespace cpu {
void BlendTile(const Splat* splats, const TileEntry* entries, int64_t count, int tile_x, int tile_y, int64_t tile,
               const BlendImage& out) {
  HWY_DYNAMIC_DISPATCH(oraclegs::BlendTile)(splats, entries, count, tile_x, tile_y, tile, out);
}
}  // namespace cpu
}  // namespace oraclegs
#endif
