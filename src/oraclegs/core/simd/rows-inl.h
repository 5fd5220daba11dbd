// Rows of numbers in memory <-> one row a lane: square transposes in registers, several times faster than gathers.

#if defined(ORACLEGS_CORE_SIMD_ROWS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ORACLEGS_CORE_SIMD_ROWS_INL_H_
#undef ORACLEGS_CORE_SIMD_ROWS_INL_H_
#else
#define ORACLEGS_CORE_SIMD_ROWS_INL_H_
#endif

#include <algorithm>
#include <cstdint>

#include "oraclegs/core/simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace oraclegs::HWY_NAMESPACE {

static_assert(kLanes == 1 || kLanes == 4 || kLanes == 8 || kLanes == 16);

#if HWY_TARGET == HWY_SCALAR  // has one lane, and none of the operations below
HWY_INLINE void Transpose(FloatVec*) {}
#else

/// Transposes within each 128-bit block: out[c] block b = (r0[4b+c], r1[4b+c], r2[4b+c], r3[4b+c]).
HWY_INLINE void TransposeBlocks4(FloatVec* r) {
  const FloatTag d;
  const hn::Repartition<double, FloatTag> dd;
  const auto lo01 = hn::BitCast(dd, hn::InterleaveLower(d, r[0], r[1]));
  const auto hi01 = hn::BitCast(dd, hn::InterleaveUpper(d, r[0], r[1]));
  const auto lo23 = hn::BitCast(dd, hn::InterleaveLower(d, r[2], r[3]));
  const auto hi23 = hn::BitCast(dd, hn::InterleaveUpper(d, r[2], r[3]));
  r[0] = hn::BitCast(d, hn::InterleaveLower(dd, lo01, lo23));
  r[1] = hn::BitCast(d, hn::InterleaveUpper(dd, lo01, lo23));
  r[2] = hn::BitCast(d, hn::InterleaveLower(dd, hi01, hi23));
  r[3] = hn::BitCast(d, hn::InterleaveUpper(dd, hi01, hi23));
}

/// (even blocks of a, even blocks of b) and (odd blocks of a, odd blocks of b), interleaved.
HWY_INLINE void ExchangeBlocks(FloatVec* a, FloatVec* b) {
  const FloatVec even = hn::OddEvenBlocks(hn::SwapAdjacentBlocks(*b), *a);
  *b = hn::OddEvenBlocks(*b, hn::SwapAdjacentBlocks(*a));
  *a = even;
}

#if HWY_TARGET <= HWY_AVX3
/// Blocks of v[0], v[stride], v[2 stride], v[3 stride] as a 4 x 4 matrix, transposed in place.
HWY_INLINE void TransposeBlocks(FloatVec* v, int stride) {
  const auto low01 = _mm512_shuffle_f32x4(v[0].raw, v[stride].raw, 0x44);  // blocks 0, 1 of both
  const auto low23 = _mm512_shuffle_f32x4(v[2 * stride].raw, v[3 * stride].raw, 0x44);
  const auto high01 = _mm512_shuffle_f32x4(v[0].raw, v[stride].raw, 0xee);  // blocks 2, 3
  const auto high23 = _mm512_shuffle_f32x4(v[2 * stride].raw, v[3 * stride].raw, 0xee);
  v[0] = FloatVec{_mm512_shuffle_f32x4(low01, low23, 0x88)};
  v[stride] = FloatVec{_mm512_shuffle_f32x4(low01, low23, 0xdd)};
  v[2 * stride] = FloatVec{_mm512_shuffle_f32x4(high01, high23, 0x88)};
  v[3 * stride] = FloatVec{_mm512_shuffle_f32x4(high01, high23, 0xdd)};
}

/// TransposeBlocks of matrices whose last row is zero; that row is not read.
HWY_INLINE void TransposeBlocksOfThree(FloatVec* v, int stride) {
  const auto low01 = _mm512_shuffle_f32x4(v[0].raw, v[stride].raw, 0x44);
  const auto low2 = _mm512_zextps256_ps512(_mm512_castps512_ps256(v[2 * stride].raw));
  const auto high01 = _mm512_shuffle_f32x4(v[0].raw, v[stride].raw, 0xee);
  const auto high2 = _mm512_zextps256_ps512(_mm512_extractf32x8_ps(v[2 * stride].raw, 1));
  v[0] = FloatVec{_mm512_shuffle_f32x4(low01, low2, 0x88)};
  v[stride] = FloatVec{_mm512_shuffle_f32x4(low01, low2, 0xdd)};
  v[2 * stride] = FloatVec{_mm512_shuffle_f32x4(high01, high2, 0x88)};
  v[3 * stride] = FloatVec{_mm512_shuffle_f32x4(high01, high2, 0xdd)};
}
#endif

/// v as a kLanes x kLanes matrix, transposed in place.
HWY_INLINE void Transpose(FloatVec* v) {
  for (int group = 0; group < kLanes; group += 4) TransposeBlocks4(v + group);
  if constexpr (kLanes == 8) {
    for (int c = 0; c < 4; ++c) ExchangeBlocks(v + c, v + 4 + c);
  }
#if HWY_TARGET <= HWY_AVX3
  for (int c = 0; c < 4; ++c) TransposeBlocks(v + c, 4);
#endif
}

#endif

/// Columns [0, kLanes * tiles) of kLanes rows, one row a lane; row(lane) is the address of one.
template <class Row>
HWY_INLINE void LoadScatteredRows(const Row& row, int tiles, FloatVec* HWY_RESTRICT columns) {
  for (int tile = 0; tile < tiles; ++tile) {
    FloatVec* v = columns + tile * kLanes;
    for (int lane = 0; lane < kLanes; ++lane) v[lane] = hn::LoadU(FloatTag(), row(lane) + tile * kLanes);
    Transpose(v);
  }
}

/// Loads `count` rows that are `stride` floats apart; the last one fills the lanes past the end.
HWY_INLINE void LoadWideRows(const float* HWY_RESTRICT rows, int stride, int count, int tiles,
                             FloatVec* HWY_RESTRICT columns) {
  const auto row = [=](int lane) HWY_ATTR { return rows + static_cast<int64_t>(std::min(lane, count - 1)) * stride; };
  LoadScatteredRows(row, tiles, columns);
}

/// The inverse for the first `count` rows; overwrites `columns`. Writes all kLanes * tiles columns.
HWY_INLINE void StoreWideRows(FloatVec* HWY_RESTRICT columns, int stride, int count, int tiles,
                              float* HWY_RESTRICT rows) {
  for (int tile = 0; tile < tiles; ++tile) {
    FloatVec* v = columns + tile * kLanes;
    Transpose(v);
    for (int lane = 0; lane < count; ++lane) {
      hn::StoreU(v[lane], FloatTag(), rows + static_cast<int64_t>(lane) * stride + tile * kLanes);
    }
  }
}

/// Rows of one, three or four floats packed without gaps.
template <int kColumns>
HWY_INLINE void LoadRows(const float* HWY_RESTRICT rows, int count, Lanes* HWY_RESTRICT columns) {
  static_assert(kColumns == 1 || kColumns == 3 || kColumns == 4);
  const FloatTag d;
  HWY_ALIGN float padded[kColumns * kLanes];
  if (count < kLanes) {
    for (int i = 0; i < kColumns * kLanes; ++i) {
      const int row = std::min(i / kColumns, count - 1);
      padded[i] = rows[row * kColumns + i % kColumns];
    }
    rows = padded;
  }
  if constexpr (kColumns == 1) columns[0].v = hn::LoadU(d, rows);
  if constexpr (kColumns == 3) hn::LoadInterleaved3(d, rows, columns[0].v, columns[1].v, columns[2].v);
  if constexpr (kColumns == 4) hn::LoadInterleaved4(d, rows, columns[0].v, columns[1].v, columns[2].v, columns[3].v);
}

template <int kColumns>
HWY_INLINE void StoreRows(const Lanes* HWY_RESTRICT columns, int count, float* HWY_RESTRICT rows) {
  static_assert(kColumns == 1 || kColumns == 3 || kColumns == 4);
  const FloatTag d;
  HWY_ALIGN float padded[kColumns * kLanes];
  float* HWY_RESTRICT to = count < kLanes ? padded : rows;
  if constexpr (kColumns == 1) hn::StoreU(columns[0].v, d, to);
  if constexpr (kColumns == 3) hn::StoreInterleaved3(columns[0].v, columns[1].v, columns[2].v, d, to);
  if constexpr (kColumns == 4) hn::StoreInterleaved4(columns[0].v, columns[1].v, columns[2].v, columns[3].v, d, to);
  if (count < kLanes) std::copy_n(padded, kColumns * count, rows);
}

}  // namespace oraclegs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
