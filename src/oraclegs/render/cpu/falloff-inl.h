// Falloff of one Gaussian over the 16 pixels of a block: the part that forward and backward must compute to the same
// bits.

#if defined(ORACLEGS_RENDER_CPU_FALLOFF_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ORACLEGS_RENDER_CPU_FALLOFF_INL_H_
#undef ORACLEGS_RENDER_CPU_FALLOFF_INL_H_
#else
#define ORACLEGS_RENDER_CPU_FALLOFF_INL_H_
#endif

#include "oraclegs/core/simd/lanes-inl.h"
#include "oraclegs/core/simd/rows-inl.h"
#include "oraclegs/render/constants.h"
#include "oraclegs/render/cpu/blocks-inl.h"
#include "oraclegs/render/cpu/kernels.h"

HWY_BEFORE_NAMESPACE();
namespace oraclegs::HWY_NAMESPACE {

/// 2^x in the lanes of `where`, where |x| < 126, and 0 elsewhere. The polynomial is the minimax one of degree 4 for 2^f
/// on an interval of length 1: relative error 2.6e-6, 2.9e-6 with rounding; the reference numbers ask for 1e-5
/// (docs/method.md#tolerances).
HWY_INLINE FloatVec Exp2Where(FloatMask where, FloatVec x) {
  const FloatTag d;
#if HWY_TARGET <= HWY_AVX3
  const FloatVec f{_mm512_reduce_ps(x.raw, 0x09)};  // x - floor(x)
  FloatVec p = hn::Set(d, 0.013534167911698657f);
  for (const float c : {0.05201146061904796f, 0.24144275688619407f, 0.6930038344710632f, 1.0000025933706653f}) {
    p = hn::MulAdd(f, p, hn::Set(d, c));
  }
  return FloatVec{_mm512_maskz_scalef_ps(where.raw, p.raw, x.raw)};  // p 2^floor(x)
#else
  const IntTag di;
  // Adding 1.5 2^23 rounds to an integer, which is left in the lowest bits.
  const FloatVec magic = hn::Set(d, 12582912.f), shifted = hn::Add(x, magic);
  const FloatVec f = hn::Sub(x, hn::Sub(shifted, magic)), square = hn::Mul(f, f);
  // Pairs of terms, for a short dependency chain.
  const FloatVec low = hn::MulAdd(f, hn::Set(d, 0.69312181f), hn::Set(d, 0.99999926f));
  const FloatVec high =
      hn::MulAdd(square, hn::Set(d, 0.0095701f), hn::MulAdd(f, hn::Set(d, 0.05591786f), hn::Set(d, 0.24024745f)));
  const FloatVec p = hn::MulAdd(square, high, low);
  const IntVec exponent = hn::ShiftLeft<23>(hn::BitCast(di, shifted));
  return hn::IfThenElseZero(where, hn::BitCast(d, hn::Add(hn::BitCast(di, p), exponent)));
#endif
}

#if HWY_TARGET > HWY_AVX3
/// For each set of lanes, given as bits, its lane numbers in order.
struct LaneSets {
  alignas(8) uint8_t numbers[1 << kLanes][kLanes];
};
constexpr LaneSets MakeLaneSets() {
  LaneSets sets{};
  for (int bits = 0; bits < 1 << kLanes; ++bits) {
    int n = 0;
    for (int lane = 0; lane < kLanes; ++lane) {
      if (bits >> lane & 1) sets.numbers[bits][n++] = static_cast<uint8_t>(lane);
    }
  }
  return sets;
}
inline constexpr LaneSets kLaneSets = MakeLaneSets();
#endif

/// Stores first + lane for each chosen lane, in order; `to` must have room for kLanes. Returns how many were stored.
HWY_INLINE int StoreChosen(int first, hn::Mask<IntTag> chosen, int32_t* to) {
  const IntTag d;
#if HWY_TARGET <= HWY_AVX3
  // Not Iota(d, first): for a number unknown at compile time it is built in memory, lane by lane.
  hn::StoreU(hn::Compress(hn::Add(hn::Iota(d, 0), hn::Set(d, first)), chosen), d, to);
  return static_cast<int>(hn::CountTrue(d, chosen));
#else
  // Without an instruction for it, hn::Compress copies a table to the stack at each call (GCC 12).
  uint8_t bits[8] = {};
  hn::StoreMaskBits(d, chosen, bits);
  const unsigned set = bits[0] & ((1u << kLanes) - 1);
  const hn::Rebind<uint8_t, IntTag> bytes;
  hn::StoreU(hn::Add(hn::PromoteTo(d, hn::LoadU(bytes, kLaneSets.numbers[set])), hn::Set(d, first)), d, to);
  return __builtin_popcount(set);
#endif
}

/// Centers of a block's pixels, relative to the tile's center.
struct BlockPixels {
  FloatVec x[kVecs], y[kVecs];

  HWY_INLINE explicit BlockPixels(int block) {
    for (int v = 0; v < kVecs; ++v) {
      x[v] = hn::Load(FloatTag(), kBlockCenters.x[block] + v * kLanes);
      y[v] = hn::Load(FloatTag(), kBlockCenters.y[block] + v * kLanes);
    }
  }
};

/// Consecutive entries of a tile's list, prepared for the blocks: the splats' numbers relative to the tile's center,
/// and for each block the positions of the splats that reach it. Fits the first-level cache.
struct HWY_ALIGN Segment {
  static constexpr int kSize = 256;
  /// Number of the first step of the segment that begins at an entry. Steps of a block's list are numbered by segment
  /// and, within it, by position in the block's own list. As BlendImage::end.
  static constexpr int32_t FirstStep(int64_t entry) { return static_cast<int32_t>(entry / kSize * 2 * kSize); }
  static constexpr int64_t FirstEntry(int32_t step) { return step / (2 * kSize) * int64_t{kSize}; }

  // alpha = 2^(peak - (ax x + a0)^2 - (bx x + by y + b0)^2)
  float ax[kSize], a0[kSize], bx[kSize], by[kSize], b0[kSize], peak[kSize];
  float r[kSize], g[kSize], b[kSize], inv_z[kSize];
  int32_t positions[cpu::kBlocksPerTile][kSize + 16];  // not 1024 bytes apart: they would share cache sets
  int counts[cpu::kBlocksPerTile];

  /// alpha of splat i (docs/method.md#blending) at the pixels of a block: 0 where it is below 1/255, at most 0.99.
  HWY_INLINE void Alphas(int i, const BlockPixels& at, FloatVec* HWY_RESTRICT alpha) const {
    Log2Alphas(i, at, alpha);
    for (int v = 0; v < kVecs; ++v) alpha[v] = CappedAlpha(Reached(alpha[v]), alpha[v]);
  }

  /// Alphas in the lanes of `where`, and 0 elsewhere.
  HWY_INLINE void AlphasWhere(const FloatMask* where, int i, const BlockPixels& at,
                              FloatVec* HWY_RESTRICT alpha) const {
    Log2Alphas(i, at, alpha);
    for (int v = 0; v < kVecs; ++v) alpha[v] = CappedAlpha(hn::And(where[v], Reached(alpha[v])), alpha[v]);
  }

  /// Fills from entries[begin, begin + n), n <= kSize; only blocks in `blocks` (a mask) get positions.
  HWY_INLINE void Fill(const cpu::TileWork& tile, int64_t begin, int n, uint32_t blocks) {
    for (int block = 0; block < cpu::kBlocksPerTile; ++block) counts[block] = 0;
    for (int i = 0; i < n; i += kLanes) {
      const cpu::TileEntry* group = tile.entries + begin + i;
      cpu::TileEntry rest[kLanes];
      if (HWY_UNLIKELY(n - i < kLanes)) {
        std::fill(std::copy(group, group + n - i, rest), rest + kLanes, cpu::TileEntry{group->id, 0, 0});
        group = rest;
      } else if (n - i >= 3 * kLanes) {
        // The splats are scattered in memory.
        for (int lane = 2 * kLanes; lane < 3 * kLanes; ++lane) __builtin_prefetch(&tile.splats[group[lane].id]);
      }
      LoadSplats(tile, group, i);
      AddPositions(group, blocks, i);
    }
  }

 private:
  /// log2(alpha), before the cap.
  HWY_INLINE void Log2Alphas(int i, const BlockPixels& at, FloatVec* HWY_RESTRICT e) const {
    const FloatTag d;
    FloatVec near, base;  // the terms of x alone, which is the same in all vectors of whole rows
    for (int v = 0; v < kVecs; ++v) {
      if (v == 0 || kLanes < cpu::kBlock) {
        const FloatVec p = hn::MulAdd(hn::Set(d, ax[i]), at.x[v], hn::Set(d, a0[i]));
        near = hn::NegMulAdd(p, p, hn::Set(d, peak[i]));
        base = hn::MulAdd(hn::Set(d, bx[i]), at.x[v], hn::Set(d, b0[i]));
      }
      const FloatVec q = hn::MulAdd(hn::Set(d, by[i]), at.y[v], base);
      e[v] = hn::NegMulAdd(q, q, near);
    }
  }

  static HWY_INLINE FloatMask Reached(FloatVec e) { return hn::Ge(e, hn::Set(FloatTag(), kLog2AlphaMin)); }

  static HWY_INLINE FloatVec CappedAlpha(FloatMask reached, FloatVec e) {
    return hn::Min(Exp2Where(reached, e), hn::Set(FloatTag(), kAlphaMax));
  }

  HWY_INLINE void LoadSplats(const cpu::TileWork& tile, const cpu::TileEntry* group, int i) {
    const FloatTag d;
    constexpr int kTiles = (cpu::kSplatFields + kLanes - 1) / kLanes;
    FloatVec field[kTiles * kLanes];
    LoadScatteredRows([&](int lane) HWY_ATTR { return &tile.splats[group[lane].id].mx; }, kTiles, field);
    const FloatVec mx = hn::Sub(field[0], hn::Set(d, static_cast<float>(tile.x * kTile + kTile / 2)));
    const FloatVec my = hn::Sub(field[1], hn::Set(d, static_cast<float>(tile.y * kTile + kTile / 2)));
    hn::Store(field[2], d, ax + i);
    hn::Store(hn::Neg(hn::Mul(field[2], mx)), d, a0 + i);
    hn::Store(hn::Mul(field[3], field[4]), d, bx + i);
    hn::Store(field[3], d, by + i);
    hn::Store(hn::Neg(hn::Mul(field[3], hn::MulAdd(field[4], mx, my))), d, b0 + i);
    hn::Store(field[5], d, peak + i);
    hn::Store(field[8], d, r + i);
    hn::Store(field[9], d, g + i);
    hn::Store(field[10], d, b + i);
    hn::Store(field[11], d, inv_z + i);
  }

  /// Appends the positions i + lane to the lists of the blocks in the lane's mask.
  HWY_INLINE void AddPositions(const cpu::TileEntry* group, uint32_t blocks, int i) {
    const IntTag di;
    IntVec ids, masks, pairs;
    hn::LoadInterleaved3(di, reinterpret_cast<const int32_t*>(group), ids, masks, pairs);
    masks = hn::And(masks, hn::Set(di, static_cast<int32_t>(blocks)));
    for (int block = 0; block < cpu::kBlocksPerTile; ++block) {
      const auto reached = hn::TestBit(masks, hn::Set(di, 1 << block));
      counts[block] += StoreChosen(i, reached, positions[block] + counts[block]);
    }
  }
};

/// Consecutive entries whose splats are needed after the current work. They are scattered in memory: prefetching all at
/// once would stall, so each block of the current work prefetches some of them.
struct Upcoming {
  const cpu::LineSplat* splats;
  const cpu::TileEntry* first;
  int64_t count;

  HWY_INLINE void Prefetch(int block) const {
    const int64_t end = count * (block + 1) / cpu::kBlocksPerTile;
    for (int64_t i = count * block / cpu::kBlocksPerTile; i < end; ++i) __builtin_prefetch(&splats[first[i].id], 0, 2);
  }
};

}  // namespace oraclegs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
