// Sums over the 16 pixels of a block for as many Gaussians as there are lanes: a Gaussian's 16 numbers are a row in
// memory, and come out as a lane of each sum.
//
// Rows are transposed within 128-bit blocks only, which takes loads of whole vectors and half the shuffles. Then a
// block of a vector is a row of pixels, and its four lanes are Gaussians; the blocks meet when the rows of pixels are
// summed.

#if defined(ORACLEGS_RENDER_CPU_PIXEL_SUMS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ORACLEGS_RENDER_CPU_PIXEL_SUMS_INL_H_
#undef ORACLEGS_RENDER_CPU_PIXEL_SUMS_INL_H_
#else
#define ORACLEGS_RENDER_CPU_PIXEL_SUMS_INL_H_
#endif

#include <algorithm>

#include "oraclegs/core/simd/lanes-inl.h"
#include "oraclegs/core/simd/rows-inl.h"
#include "oraclegs/render/cpu/kernels.h"

HWY_BEFORE_NAMESPACE();
namespace oraclegs::HWY_NAMESPACE {

static_assert(cpu::kBlock == 4);

/// Rows of pixels in a vector; Gaussians come in as many fours, `quads`.
inline constexpr int kRowsAVector = std::max(kLanes / 4, 1);
/// Vectors that hold all rows.
inline constexpr int kRowGroups = 4 / kRowsAVector;

/// Center of a block, in pixels from the tile's center.
struct BlockMiddle {
  float x, y;
};

/// Loads four Gaussians, or one with one lane: vector x has the pixels of column x, in row group `group`.
HWY_INLINE void LoadColumns(const float (*HWY_RESTRICT gaussians)[16], int group, FloatVec* HWY_RESTRICT columns) {
  const FloatTag d;
#if HWY_TARGET == HWY_SCALAR
  for (int x = 0; x < 4; ++x) columns[x] = hn::Load(d, gaussians[0] + 4 * group + x);
#else
  for (int r = 0; r < 4; ++r) columns[r] = hn::Load(d, gaussians[r] + group * kLanes);
  TransposeBlocks4(columns);
#endif
}

/// v[q] with block b a row of pixels, of four Gaussians q -> v[b] with block q, of row b.
HWY_INLINE void ExchangeRowsAndQuads(FloatVec* v) {
#if HWY_TARGET <= HWY_AVX3
  TransposeBlocks(v, 1);
#elif HWY_TARGET == HWY_AVX2
  ExchangeBlocks(v, v + 1);
#else
  static_cast<void>(v);  // a vector is one row
#endif
}

/// v[q] with block b a row of pixels, of four Gaussians q -> the sums over rows, with block q.
HWY_INLINE FloatVec SumRows(const FloatVec* v) {
#if HWY_TARGET <= HWY_AVX3
  const auto halves = [](FloatVec a, FloatVec b) HWY_ATTR {
    return _mm512_add_ps(_mm512_shuffle_f32x4(a.raw, b.raw, 0x44), _mm512_shuffle_f32x4(a.raw, b.raw, 0xee));
  };
  const __m512 low = halves(v[0], v[1]), high = halves(v[2], v[3]);
  return FloatVec{_mm512_add_ps(_mm512_shuffle_f32x4(low, high, 0x88), _mm512_shuffle_f32x4(low, high, 0xdd))};
#elif HWY_TARGET == HWY_AVX2
  const FloatTag d;
  return hn::Add(hn::ConcatLowerLower(d, v[1], v[0]), hn::ConcatUpperUpper(d, v[1], v[0]));
#else
  return v[0];
#endif
}

/// Sums over the block's pixels of h 1, X, Y, X^2, X Y, Y^2, with X, Y from the tile's center.
HWY_INLINE void SumMoments(const float (*HWY_RESTRICT h)[16], const BlockMiddle& middle,
                           FloatVec* HWY_RESTRICT moments) {
  const FloatTag d;
  const FloatVec three = hn::Set(d, 3.f), nine = hn::Set(d, 9.f);
  // Four neighbors at -3/2, -1/2, 1/2, 3/2: their sum, first moment in halves, second moment in quarters.
  const auto sum = [&](FloatVec a, FloatVec b, FloatVec c, FloatVec e)
                       HWY_ATTR { return hn::Add(hn::Add(a, e), hn::Add(b, c)); };
  const auto first = [&](FloatVec a, FloatVec b, FloatVec c, FloatVec e)
                         HWY_ATTR { return hn::MulAdd(three, hn::Sub(e, a), hn::Sub(c, b)); };
  const auto second = [&](FloatVec a, FloatVec b, FloatVec c, FloatVec e)
                          HWY_ATTR { return hn::MulAdd(nine, hn::Add(a, e), hn::Add(b, c)); };
  FloatVec row[4], row_x[4], row_xx[4];
  for (int i = 0; i < 4; ++i) {
    FloatVec p[4];
    LoadColumns(h + i % kRowsAVector * 4, i / kRowsAVector, p);
    row[i] = sum(p[0], p[1], p[2], p[3]);
    row_x[i] = first(p[0], p[1], p[2], p[3]);
    row_xx[i] = second(p[0], p[1], p[2], p[3]);
  }
  for (int group = 0; group < kRowGroups; ++group) {
    ExchangeRowsAndQuads(row + group * kRowsAVector), ExchangeRowsAndQuads(row_x + group * kRowsAVector);
    for (int quad = 0; quad < kRowsAVector; ++quad) {
      if (group > 0) row_xx[quad] = hn::Add(row_xx[quad], row_xx[group * kRowsAVector + quad]);
    }
  }
  const auto halves = [&](FloatVec m) HWY_ATTR { return hn::Mul(hn::Set(d, 0.5f), m); };
  const auto quarters = [&](FloatVec m) HWY_ATTR { return hn::Mul(hn::Set(d, 0.25f), m); };
  const FloatVec m = sum(row[0], row[1], row[2], row[3]);
  const FloatVec x = halves(sum(row_x[0], row_x[1], row_x[2], row_x[3]));
  const FloatVec y = halves(first(row[0], row[1], row[2], row[3]));
  const FloatVec xx = quarters(SumRows(row_xx));
  const FloatVec xy = quarters(first(row_x[0], row_x[1], row_x[2], row_x[3]));
  const FloatVec yy = quarters(second(row[0], row[1], row[2], row[3]));
  // Moves the moments from the block's center to the tile's.
  const FloatVec vx = hn::Set(d, middle.x), vy = hn::Set(d, middle.y);
  const FloatVec shifted_x = hn::MulAdd(vx, m, x), shifted_y = hn::MulAdd(vy, m, y);
  moments[0] = m;
  moments[1] = shifted_x;
  moments[2] = shifted_y;
  moments[3] = hn::MulAdd(vx, hn::Add(shifted_x, x), xx);
  moments[4] = hn::MulAdd(vx, shifted_y, hn::MulAdd(vy, x, xy));
  moments[5] = hn::MulAdd(vy, hn::Add(shifted_y, y), yy);
}

/// Fills vector x with each lane's pixel of its row in column x.
HWY_INLINE void BroadcastColumns(const float* HWY_RESTRICT pixels, int group, FloatVec* HWY_RESTRICT columns) {
  const FloatTag d;
#if HWY_TARGET == HWY_SCALAR
  for (int x = 0; x < 4; ++x) columns[x] = hn::Load(d, pixels + 4 * group + x);
#elif HWY_TARGET <= HWY_AVX3
  const __m512 rows = hn::Load(d, pixels + group * kLanes).raw;  // hn::Broadcast shuffles two operands, at some cost
  columns[0] = FloatVec{_mm512_permute_ps(rows, 0x00)}, columns[1] = FloatVec{_mm512_permute_ps(rows, 0x55)};
  columns[2] = FloatVec{_mm512_permute_ps(rows, 0xaa)}, columns[3] = FloatVec{_mm512_permute_ps(rows, 0xff)};
#else
  const FloatVec rows = hn::Load(d, pixels + group * kLanes);
  columns[0] = hn::Broadcast<0>(rows), columns[1] = hn::Broadcast<1>(rows);
  columns[2] = hn::Broadcast<2>(rows), columns[3] = hn::Broadcast<3>(rows);
#endif
}

/// sums[c] = sum over the block's pixels of w g[c].
template <int kChannels>
HWY_INLINE void SumProducts(const float (*HWY_RESTRICT w)[16], const float (*HWY_RESTRICT g)[16],
                            FloatVec* HWY_RESTRICT sums) {
  FloatVec columns[kRowGroups][kRowsAVector][4];
  for (int group = 0; group < kRowGroups; ++group) {
    for (int quad = 0; quad < kRowsAVector; ++quad) LoadColumns(w + 4 * quad, group, columns[group][quad]);
  }
  for (int c = 0; c < kChannels; ++c) {
    FloatVec of_quads[kRowsAVector];
    for (FloatVec& sum : of_quads) sum = hn::Zero(FloatTag());
    for (int group = 0; group < kRowGroups; ++group) {
      FloatVec of_column[4];
      BroadcastColumns(g[c], group, of_column);
      for (int quad = 0; quad < kRowsAVector; ++quad) {
        const FloatVec* const v = columns[group][quad];
        for (int x = 3; x >= 0; --x) of_quads[quad] = hn::MulAdd(v[x], of_column[x], of_quads[quad]);
      }
    }
    sums[c] = SumRows(of_quads);
  }
}

/// Adds lane k of columns [0, 12) to record positions[k], for `count` lanes. Overwrites the columns; the array has room
/// for cpu::kGradStride.
HWY_INLINE void AddToRecords(FloatVec* HWY_RESTRICT columns, const int32_t* HWY_RESTRICT positions, int count,
                             float* HWY_RESTRICT records) {
  const auto add = [&](auto d, auto row, int lane, int first) HWY_ATTR {
    float* to = records + positions[lane] * cpu::kGradStride + first;
    hn::Store(hn::Add(hn::Load(d, to), row), d, to);
  };
  const FloatTag d;
#if HWY_TARGET <= HWY_AVX3
  for (int c = 0; c < 12; c += 4) TransposeBlocks4(columns + c);
  for (int c = 0; c < 4; ++c) TransposeBlocksOfThree(columns + c, 4);
  for (int lane = 0; lane < kLanes && lane < count; ++lane) add(d, columns[lane], lane, 0);
#elif HWY_TARGET == HWY_AVX2
  Transpose(columns);
  TransposeBlocks4(columns + 8);
  const hn::Half<FloatTag> half;
  for (int lane = 0; lane < count; ++lane) {
    add(d, columns[lane], lane, 0);
    add(half, lane < 4 ? hn::LowerHalf(half, columns[8 + lane]) : hn::UpperHalf(half, columns[4 + lane]), lane, 8);
  }
#else
  for (int first = 0; first < 12; first += kLanes) {
    Transpose(columns + first);
    for (int lane = 0; lane < count; ++lane) add(d, columns[first + lane], lane, first);
  }
#endif
}

}  // namespace oraclegs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
