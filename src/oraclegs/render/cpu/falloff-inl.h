// How one Gaussian covers the 16 pixels of a block: the part that forward and backward must compute to the same bits.

#if defined(ORACLEGS_RENDER_CPU_FALLOFF_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ORACLEGS_RENDER_CPU_FALLOFF_INL_H_
#undef ORACLEGS_RENDER_CPU_FALLOFF_INL_H_
#else
#define ORACLEGS_RENDER_CPU_FALLOFF_INL_H_
#endif

#include "oraclegs/render/constants.h"
#include "oraclegs/render/cpu/kernels.h"
#include "oraclegs/render/cpu/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace oraclegs::HWY_NAMESPACE {

/// Vectors that make up a block of 16 pixels.
inline constexpr int kVecs = 16 / kLanes;

/// 2^x for |x| < 126. The polynomial is the minimax one for 2^f, |f| <= 1/2, relative error 7.5e-8; with rounding the
/// whole stays below 2.5e-7, the fixtures ask for 1e-5.
HWY_INLINE FloatVec Exp2(FloatVec x) {
  const FloatTag d;
  const IntTag di;
  const FloatVec n = hn::Round(x);
  const FloatVec f = hn::Sub(x, n);
  FloatVec p = hn::MulAdd(hn::Set(d, 0.0013276471979478776f), f, hn::Set(d, 0.00967554133421605f));
  p = hn::MulAdd(p, f, hn::Set(d, 0.05550713273542586f));
  p = hn::MulAdd(p, f, hn::Set(d, 0.24022119723848476f));
  p = hn::MulAdd(p, f, hn::Set(d, 0.6931469670647331f));
  p = hn::MulAdd(p, f, hn::Set(d, 1.0000000716546822f));
  return hn::BitCast(d, hn::Add(hn::BitCast(di, p), hn::ShiftLeft<23>(hn::ConvertTo(di, n))));
}

/// Pixel centres of block (bx, by) relative to the tile's centre.
struct BlockPixels {
  FloatVec x[kVecs], y[kVecs];
  HWY_INLINE explicit BlockPixels(int block) {
    const FloatTag d;
    HWY_ALIGN float px[16], py[16];
    for (int i = 0; i < 16; ++i) {
      px[i] = static_cast<float>(block % 4 * cpu::kBlock + i % cpu::kBlock) + 0.5f - cpu::kTile / 2;
      py[i] = static_cast<float>(block / 4 * cpu::kBlock + i / cpu::kBlock) + 0.5f - cpu::kTile / 2;
    }
    for (int v = 0; v < kVecs; ++v) {
      x[v] = hn::Load(d, px + v * kLanes);
      y[v] = hn::Load(d, py + v * kLanes);
    }
  }
};

struct Coverage {
  FloatVec alpha;  ///< capped; meaningless where not covered
  FloatVec raw;    ///< before the cap
  FloatMask covered;
};

/// alpha of a splat whose centre is relative to the tile's centre (spec 4): skipped where the exponent is positive or
/// alpha is below 1/255.
HWY_INLINE Coverage Cover(const cpu::Splat& s, FloatVec x, FloatVec y) {
  const FloatTag d;
  const FloatVec dx = hn::Sub(x, hn::Set(d, s.mx)), dy = hn::Sub(y, hn::Set(d, s.my));
  const FloatVec along_x = hn::MulAdd(hn::Set(d, s.qxx), dx, hn::Mul(hn::Set(d, s.qxy), dy));
  const FloatVec power = hn::MulAdd(along_x, dx, hn::Mul(hn::Mul(hn::Set(d, s.qyy), dy), dy));
  const FloatVec e = hn::Add(power, hn::Set(d, s.log2_opacity));
  constexpr float kLog2AlphaMin = -7.99435343685886f;  // log2(1/255): deciding on the exponent spares wild lanes
  Coverage c;
  c.raw = Exp2(e);
  c.alpha = hn::Min(c.raw, hn::Set(d, kAlphaMax));
  c.covered = hn::And(hn::Le(power, hn::Zero(d)), hn::Ge(e, hn::Set(d, kLog2AlphaMin)));
  return c;
}

/// A stretch of a tile's list, made ready for the blocks: splats side by side with centres relative to the tile, and
/// for each block the positions of those that reach it. Small enough for the first-level cache.
struct Segment {
  static constexpr int kSize = 256;
  cpu::Splat splats[kSize];
  uint16_t positions[cpu::kBlocksPerTile][kSize];
  int counts[cpu::kBlocksPerTile];

  /// Fills from entries[begin, begin + n), n <= kSize; only blocks in `wanted` (a mask) get positions.
  HWY_INLINE void Fill(const cpu::Splat* all, const cpu::TileEntry* entries, int n, float center_x, float center_y,
                       uint32_t wanted) {
    for (int b = 0; b < cpu::kBlocksPerTile; ++b) counts[b] = 0;
    for (int i = 0; i < n; ++i) {
      splats[i] = all[entries[i].id];
      splats[i].mx -= center_x;
      splats[i].my -= center_y;
      for (uint32_t mask = entries[i].mask & wanted; mask != 0; mask &= mask - 1) {
        const int b = __builtin_ctz(mask);
        positions[b][counts[b]++] = static_cast<uint16_t>(i);
      }
    }
  }
};

}  // namespace oraclegs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
