// Backward blending. One task a tile, blocks as in forward, the list far to near from the last contributor.
//
// With v = g_C . c + g_D / z of a Gaussian and s the same of everything behind it (background and alpha's gradient
// included), dL/d(alpha) = T (v - s): one running number a pixel instead of a colour. The per-pixel products
// h = alpha dL/d(alpha) and w = alpha T are summed over the block against fixed pixel moments, as sums over the tile's
// centre; no horizontal reduction, no atomics: each (tile, Gaussian) pair has its own record.

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "oraclegs/render/cpu/blend_backward.cpp"
#include "oraclegs/render/cpu/hwy_targets.h"
// clang-format off: foreach_target must come before the other Highway headers
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/highway.h>

#include <algorithm>
#include <cstring>

#include "oraclegs/render/cpu/falloff-inl.h"
#include "oraclegs/render/cpu/kernels.h"

HWY_BEFORE_NAMESPACE();
namespace oraclegs::HWY_NAMESPACE {

/// A block's running state and its pixels' upstream gradients.
struct HWY_ALIGN BlockAdjoint {
  float t[16];       ///< transmittance behind the current Gaussian
  float behind[16];  ///< s above
  float gr[16], gg[16], gb[16], gz[16];
  int32_t last[16];
  // Row p holds what pixel p's h (left half) and w (right half) are multiplied by in the record.
  float moments[16][8];   ///< 1, X, Y, XX, XY, YY, 0, 0
  float upstream[16][8];  ///< g_r, g_g, g_b, g_z, 0 ...
  int32_t farthest = 0;   ///< largest of last
};

using HalfTag = hn::CappedTag<float, 8>;
inline constexpr int kHalfLanes = static_cast<int>(hn::MaxLanes(HalfTag()));
inline constexpr int kHalfVecs = 8 / kHalfLanes;

/// record[0..7] += sum_p h[p] moments[p], record[8..15] += sum_p w[p] upstream[p].
HWY_INLINE void Accumulate(const float* HWY_RESTRICT h, const float* HWY_RESTRICT w, const BlockAdjoint& block,
                           float* HWY_RESTRICT record) {
  const HalfTag d;
  for (int half = 0; half < kHalfVecs; ++half) {
    const int o = half * kHalfLanes;
    // Two chains each, to hide the latency of the multiply-add.
    auto a0 = hn::Load(d, record + o), a1 = hn::Zero(d);
    auto b0 = hn::Load(d, record + 8 + o), b1 = hn::Zero(d);
    for (int p = 0; p < 16; p += 2) {
      a0 = hn::MulAdd(hn::Set(d, h[p]), hn::Load(d, block.moments[p] + o), a0);
      b0 = hn::MulAdd(hn::Set(d, w[p]), hn::Load(d, block.upstream[p] + o), b0);
      a1 = hn::MulAdd(hn::Set(d, h[p + 1]), hn::Load(d, block.moments[p + 1] + o), a1);
      b1 = hn::MulAdd(hn::Set(d, w[p + 1]), hn::Load(d, block.upstream[p + 1] + o), b1);
    }
    hn::Store(hn::Add(a0, a1), d, record + o);
    hn::Store(hn::Add(b0, b1), d, record + 8 + o);
  }
}

HWY_INLINE void BackwardBlock(const Segment& segment, int block, int32_t first, BlockAdjoint* state,
                              float* HWY_RESTRICT records) {
  const FloatTag d;
  const IntTag di;
  const BlockPixels pixels(block);
  FloatVec t[kVecs], behind[kVecs], gr[kVecs], gg[kVecs], gb[kVecs], gz[kVecs];
  IntVec last[kVecs];
  for (int v = 0; v < kVecs; ++v) {
    t[v] = hn::Load(d, state->t + v * kLanes);
    behind[v] = hn::Load(d, state->behind + v * kLanes);
    gr[v] = hn::Load(d, state->gr + v * kLanes);
    gg[v] = hn::Load(d, state->gg + v * kLanes);
    gb[v] = hn::Load(d, state->gb + v * kLanes);
    gz[v] = hn::Load(d, state->gz + v * kLanes);
    last[v] = hn::Load(di, state->last + v * kLanes);
  }
  HWY_ALIGN float h[16], w[16];
  const uint16_t* HWY_RESTRICT positions = segment.positions[block];
  for (int j = segment.counts[block] - 1; j >= 0; --j) {
    const cpu::Splat& s = segment.splats[positions[j]];
    const IntVec position = hn::Set(di, first + positions[j]);
    bool any = false;
    for (int v = 0; v < kVecs; ++v) {
      const Coverage c = Cover(s, pixels.x[v], pixels.y[v]);
      const FloatMask hit = hn::And(c.covered, hn::RebindMask(d, hn::Gt(last[v], position)));
      any |= !hn::AllFalse(d, hit);
      const FloatVec alpha = hn::IfThenElseZero(hit, c.alpha);
      t[v] = hn::Div(t[v], hn::Sub(hn::Set(d, 1.f), alpha));
      FloatVec value = hn::Mul(gr[v], hn::Set(d, s.r));
      value = hn::MulAdd(gg[v], hn::Set(d, s.g), value);
      value = hn::MulAdd(gb[v], hn::Set(d, s.b), value);
      value = hn::MulAdd(gz[v], hn::Set(d, s.inv_z), value);
      const FloatVec difference = hn::Sub(value, behind[v]);
      const FloatVec weight = hn::Mul(alpha, t[v]);
      behind[v] = hn::MulAdd(alpha, difference, behind[v]);
      hn::Store(weight, d, w + v * kLanes);
      // At the cap alpha no longer moves with the Gaussian.
      hn::Store(hn::IfThenZeroElse(hn::Ge(c.raw, hn::Set(d, kAlphaMax)), hn::Mul(weight, difference)), d,
                h + v * kLanes);
    }
    if (any) Accumulate(h, w, *state, records + static_cast<int64_t>(first + positions[j]) * cpu::kGradStride);
  }
  for (int v = 0; v < kVecs; ++v) {
    hn::Store(t[v], d, state->t + v * kLanes);
    hn::Store(behind[v], d, state->behind + v * kLanes);
  }
}

HWY_INLINE void LoadBlock(const cpu::BlendImage& forward, const cpu::BlendUpstream& up, int tile_x, int tile_y,
                          int64_t offset, int block, BlockAdjoint* s) {
  const int x0 = tile_x * cpu::kTile + block % 4 * cpu::kBlock, y0 = tile_y * cpu::kTile + block / 4 * cpu::kBlock;
  s->farthest = 0;
  for (int i = 0; i < 16; ++i) {
    const int x = x0 + i % 4, y = y0 + i / 4;
    const bool inside = x < forward.width && y < forward.height;
    const int64_t pixel = inside ? static_cast<int64_t>(y) * forward.width + x : 0;
    const bool has_image = inside && up.image != nullptr;
    s->gr[i] = has_image ? up.image[3 * pixel] : 0;
    s->gg[i] = has_image ? up.image[3 * pixel + 1] : 0;
    s->gb[i] = has_image ? up.image[3 * pixel + 2] : 0;
    s->gz[i] = inside && up.inv_depth != nullptr ? up.inv_depth[pixel] : 0;
    const float g_alpha = inside && up.alpha != nullptr ? up.alpha[pixel] : 0;
    s->behind[i] = s->gr[i] * forward.background[0] + s->gg[i] * forward.background[1] +
                   s->gb[i] * forward.background[2] - g_alpha;
    s->t[i] = forward.transmittance[offset + i];
    s->last[i] = static_cast<int32_t>(forward.last[offset + i]);
    s->farthest = std::max(s->farthest, s->last[i]);
    const float px = static_cast<float>(block % 4 * 4 + i % 4) + 0.5f - cpu::kTile / 2;
    const float py = static_cast<float>(block / 4 * 4 + i / 4) + 0.5f - cpu::kTile / 2;
    const float moments[8] = {1, px, py, px * px, px * py, py * py, 0, 0};
    const float upstream[8] = {s->gr[i], s->gg[i], s->gb[i], s->gz[i], 0, 0, 0, 0};
    std::memcpy(s->moments[i], moments, sizeof(moments));
    std::memcpy(s->upstream[i], upstream, sizeof(upstream));
  }
}

HWY_NOINLINE void BlendTileBackward(const cpu::Splat* splats, const cpu::TileEntry* entries, int64_t count, int tile_x,
                                    int tile_y, int64_t tile, const cpu::BlendImage& forward,
                                    const cpu::BlendUpstream& upstream, float* records) {
  if (count == 0) return;
  BlockAdjoint states[cpu::kBlocksPerTile];
  int64_t farthest = 0;
  for (int block = 0; block < cpu::kBlocksPerTile; ++block) {
    LoadBlock(forward, upstream, tile_x, tile_y, tile * cpu::kTilePixels + block * 16, block, &states[block]);
    farthest = std::max<int64_t>(farthest, states[block].farthest);
  }
  std::memset(records, 0, sizeof(float) * cpu::kGradStride * count);
  const float center_x = static_cast<float>(tile_x * cpu::kTile + cpu::kTile / 2);
  const float center_y = static_cast<float>(tile_y * cpu::kTile + cpu::kTile / 2);
  Segment segment;
  for (int64_t begin = (farthest - 1) / Segment::kSize * Segment::kSize; begin >= 0 && farthest > 0;
       begin -= Segment::kSize) {
    const int n = static_cast<int>(std::min<int64_t>(Segment::kSize, farthest - begin));
    uint32_t wanted = 0;
    for (int block = 0; block < cpu::kBlocksPerTile; ++block) {
      if (states[block].farthest > begin) wanted |= 1u << block;
    }
    segment.Fill(splats, entries + begin, n, center_x, center_y, wanted);
    for (uint32_t left = wanted; left != 0; left &= left - 1) {
      const int block = __builtin_ctz(left);
      BackwardBlock(segment, block, static_cast<int32_t>(begin), &states[block], records);
    }
  }
}

}  // namespace oraclegs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace oraclegs {
HWY_EXPORT(BlendTileBackward);

namespace cpu {
void BlendTileBackward(const Splat* splats, const TileEntry* entries, int64_t count, int tile_x, int tile_y,
                       int64_t tile, const BlendImage& forward, const BlendUpstream& upstream, float* records) {
  HWY_DYNAMIC_DISPATCH(oraclegs::BlendTileBackward)
  (splats, entries, count, tile_x, tile_y, tile, forward, upstream, records);
}
}  // namespace cpu
}  // namespace oraclegs
#endif
