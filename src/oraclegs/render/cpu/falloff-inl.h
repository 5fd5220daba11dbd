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
#include "oraclegs/render/cpu/rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace oraclegs::HWY_NAMESPACE {

/// Vectors that make up a block of 16 pixels.
inline constexpr int kVecs = 16 / kLanes;

inline constexpr float kLog2AlphaMin = -7.99435343685886f;  // log2(1/255)

/// 2^x in the lanes of `where`, where |x| < 126, and 0 elsewhere. The polynomial is the minimax one of degree 4 for 2^f on
/// [0, 1): relative error 2.6e-6, 2.9e-6 with rounding; the fixtures ask for 1e-5 (spec 12).
HWY_INLINE FloatVec Exp2Where(FloatMask where, FloatVec x) {
  const FloatTag d;
#if HWY_TARGET <= HWY_AVX3
  const FloatVec f{_mm512_reduce_ps(x.raw, 0x09)};  // x - floor(x)
#else
  const FloatVec floor = hn::Floor(x);
  const FloatVec f = hn::Sub(x, floor);
#endif
  FloatVec p = hn::MulAdd(hn::Set(d, 0.013534167911698657f), f, hn::Set(d, 0.05201146061904796f));
  p = hn::MulAdd(p, f, hn::Set(d, 0.24144275688619407f));
  p = hn::MulAdd(p, f, hn::Set(d, 0.6930038344710632f));
  p = hn::MulAdd(p, f, hn::Set(d, 1.0000025933706653f));
#if HWY_TARGET <= HWY_AVX3
  return FloatVec{_mm512_maskz_scalef_ps(where.raw, p.raw, x.raw)};  // p 2^floor(x)
#else
  const IntTag di;
  const IntVec exponent = hn::ShiftLeft<23>(hn::ConvertTo(di, floor));
  return hn::IfThenElseZero(where, hn::BitCast(d, hn::Add(hn::BitCast(di, p), exponent)));
#endif
}

/// First pixel of a tile's block in the image.
HWY_INLINE int BlockX(const cpu::TileWork& tile, int block) { return tile.x * cpu::kTile + block % 4 * cpu::kBlock; }
HWY_INLINE int BlockY(const cpu::TileWork& tile, int block) { return tile.y * cpu::kTile + block / 4 * cpu::kBlock; }

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

/// A stretch of a tile's list, made ready for the blocks: the splats' numbers relative to the tile's centre, and for
/// each block the positions of the splats that reach it. Small enough for the first-level cache.
struct HWY_ALIGN Segment {
  static constexpr int kSize = 256;
  // alpha = 2^(peak - (ax x + a0)^2 - (bx x + by y + b0)^2)
  float ax[kSize], a0[kSize], bx[kSize], by[kSize], b0[kSize], peak[kSize];
  float r[kSize], g[kSize], b[kSize], inv_z[kSize];
  int32_t positions[cpu::kBlocksPerTile][kSize + 16];  // the last store of a row may reach 16 past its end
  int counts[cpu::kBlocksPerTile];

  /// alpha of splat i (spec 4) at pixels x, y: 0 where it is below 1/255, at most 0.99.
  HWY_INLINE FloatVec Alpha(int i, FloatVec x, FloatVec y) const {
    const FloatVec e = Log2Alpha(i, x, y);
    return CappedAlpha(hn::Ge(e, hn::Set(FloatTag(), kLog2AlphaMin)), e);
  }

  /// The same, and 0 outside of `where`.
  HWY_INLINE FloatVec AlphaWhere(FloatMask where, int i, FloatVec x, FloatVec y) const {
    const FloatVec e = Log2Alpha(i, x, y);
    return CappedAlpha(hn::And(where, hn::Ge(e, hn::Set(FloatTag(), kLog2AlphaMin))), e);
  }

  /// Fills from entries[begin, begin + n), n <= kSize; only blocks in `wanted` (a mask) get positions.
  HWY_INLINE void Fill(const cpu::TileWork& tile, int64_t begin, int n, uint32_t wanted) {
    const cpu::TileEntry* HWY_RESTRICT entries = tile.entries + begin;
    for (int block = 0; block < cpu::kBlocksPerTile; ++block) counts[block] = 0;
    for (int i = 0; i < n; i += kLanes) {
      LoadSplats(tile, begin, i, n);
      HWY_ALIGN int32_t masks[kLanes];
      for (int lane = 0; lane < kLanes; ++lane) {
        masks[lane] = i + lane < n ? static_cast<int32_t>(entries[i + lane].mask & wanted) : 0;
      }
      AddPositions(hn::Load(IntTag(), masks), i);
    }
  }

 private:
  HWY_INLINE FloatVec Log2Alpha(int i, FloatVec x, FloatVec y) const {
    const FloatTag d;
    const FloatVec p = hn::MulAdd(hn::Set(d, ax[i]), x, hn::Set(d, a0[i]));
    const FloatVec q = hn::MulAdd(hn::Set(d, bx[i]), x, hn::MulAdd(hn::Set(d, by[i]), y, hn::Set(d, b0[i])));
    return hn::NegMulAdd(q, q, hn::NegMulAdd(p, p, hn::Set(d, peak[i])));
  }

  static HWY_INLINE FloatVec CappedAlpha(FloatMask reached, FloatVec e) {
    return hn::Min(Exp2Where(reached, e), hn::Set(FloatTag(), kAlphaMax));
  }

  HWY_INLINE void LoadSplats(const cpu::TileWork& tile, int64_t begin, int i, int n) {
    const FloatTag d;
    constexpr int kTiles = (cpu::kSplatFields + kLanes - 1) / kLanes;
    constexpr int kAhead = 16;  // entries: the splats lie anywhere in memory
    for (int64_t next = begin + i + kAhead; next < std::min(tile.count, begin + i + kAhead + kLanes); ++next) {
      __builtin_prefetch(&tile.splats[tile.entries[next].id]);
    }
    FloatVec field[kTiles * kLanes];
    const auto row = [&](int lane) HWY_ATTR {
      return &tile.splats[tile.entries[begin + std::min(i + lane, n - 1)].id].mx;
    };
    LoadScatteredRows(row, kTiles, field);
    const FloatVec mx = hn::Sub(field[0], hn::Set(d, static_cast<float>(tile.x * cpu::kTile + cpu::kTile / 2)));
    const FloatVec my = hn::Sub(field[1], hn::Set(d, static_cast<float>(tile.y * cpu::kTile + cpu::kTile / 2)));
    hn::Store(field[2], d, ax + i);
    hn::Store(hn::Neg(hn::Mul(field[2], mx)), d, a0 + i);
    hn::Store(hn::Mul(field[3], field[4]), d, bx + i);
    hn::Store(field[3], d, by + i);
    hn::Store(hn::Neg(hn::Mul(field[3], hn::MulAdd(field[4], mx, my))), d, b0 + i);
    hn::Store(field[5], d, peak + i);
    hn::Store(field[6], d, r + i);
    hn::Store(field[7], d, g + i);
    hn::Store(field[8], d, b + i);
    hn::Store(field[9], d, inv_z + i);
  }

  /// Appends the positions i + lane to the lists of the blocks in the lane's mask.
  HWY_INLINE void AddPositions(IntVec masks, int i) {
    const IntTag di;
    const IntVec position = hn::Iota(di, i);
    for (int block = 0; block < cpu::kBlocksPerTile; ++block) {
      const auto reached = hn::TestBit(masks, hn::Set(di, 1 << block));
      hn::StoreU(hn::Compress(position, reached), di, positions[block] + counts[block]);
      counts[block] += static_cast<int>(hn::CountTrue(di, reached));
    }
  }
};

}  // namespace oraclegs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
