// The tiles, and the 4 x 4 blocks in them, that a Gaussian reaches: the exact minimum of its quadratic form over each
// block's pixel centers, one block a lane.

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "oraclegs/render/cpu/cover_tiles.cpp"
#include "oraclegs/core/hwy_targets.h"
// clang-format off: foreach_target must come before the other Highway headers
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/highway.h>

#include "oraclegs/render/blend_math-inl.h"
#include "oraclegs/render/cpu/falloff-inl.h"

HWY_BEFORE_NAMESPACE();
namespace oraclegs::HWY_NAMESPACE {

/// Offsets of the 16 blocks' first pixel centers from the tile's corner.
struct BlockOffsets {
  HWY_ALIGN float x[16], y[16];
};
constexpr BlockOffsets MakeBlockOffsets() {
  BlockOffsets o{};
  for (int i = 0; i < 16; ++i) {
    o.x[i] = static_cast<float>(i % 4 * cpu::kBlock) + 0.5f;
    o.y[i] = static_cast<float>(i / 4 * cpu::kBlock) + 0.5f;
  }
  return o;
}
HWY_ALIGN constexpr BlockOffsets kBlockOffsets = MakeBlockOffsets();

/// Bit i of the result is lane i of the mask.
HWY_INLINE uint32_t MaskBits(LanesMask mask) {
#if HWY_TARGET <= HWY_AVX3
  return mask.m.raw;
#else
  uint8_t bits[8] = {};  // room for what StoreMaskBits may write
  hn::StoreMaskBits(FloatTag(), mask.m, bits);
  return bits[0] & ((1u << kLanes) - 1);
#endif
}

/// Writes the tiles of one Gaussian.
HWY_INLINE uint32_t CoverOne(const cpu::LineSplat& s, const TileRect& rect, int tiles_x, uint32_t pair,
                             const cpu::CoverOutput& out) {
  const FloatTag d;
  const ReachTerms<Lanes> reach = ReachTermsOf(Lanes(s.ax), Lanes(s.by), Lanes(s.slope), Lanes(s.log2_opacity));
  const Lanes span(static_cast<float>(cpu::kBlock - 1));
  // One loop over the rectangle: most hold one or a few tiles, and the end of a second loop would be mispredicted.
  int tx = rect.x0, ty = rect.y0;
  for (int left = rect.Count(); left > 0; --left) {
    const Lanes corner_x(static_cast<float>(tx * kTile) - s.mx), corner_y(static_cast<float>(ty * kTile) - s.my);
    uint32_t mask = 0;
    for (int v = 0; v < 16; v += kLanes) {
      const Lanes x0 = corner_x + Lanes(hn::Load(d, kBlockOffsets.x + v));
      const Lanes y0 = corner_y + Lanes(hn::Load(d, kBlockOffsets.y + v));
      mask |= MaskBits(Reaches(reach, x0, y0, span, span)) << v;
    }
    out.pair_tile[pair] = static_cast<uint32_t>(ty * tiles_x + tx);
    out.pair_mask[pair] = mask;
    pair += mask != 0;
    const bool row_ends = ++tx == rect.x1;
    ty += row_ends;
    tx = row_ends ? rect.x0 : tx;
  }
  return pair;
}

HWY_NOINLINE uint32_t CoverTiles(const cpu::CoverInput& in, int64_t begin, int64_t end, uint32_t pair,
                                 const cpu::CoverOutput& out) {
  for (int64_t i = begin; i < end; ++i) {
    const uint32_t first = pair;
    if (in.rects[i].Count() > 0) pair = CoverOne(in.splats[i], in.rects[i], in.tiles_x, pair, out);
    out.ranges[i] = {first, pair - first};
  }
  return pair;
}

}  // namespace oraclegs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace oraclegs {
HWY_EXPORT(CoverTiles);

namespace cpu {
uint32_t CoverTiles(const CoverInput& in, int64_t begin, int64_t end, uint32_t first_pair, const CoverOutput& out) {
  return HWY_DYNAMIC_DISPATCH(CoverTiles)(in, begin, end, first_pair, out);
}
}  // namespace cpu
}  // namespace oraclegs
#endif
