// Fused L1 + SSIM with gradient (docs/method.md#ssim). A tile is read top to bottom, once. Rows hold interleaved
// RGB, so a pixel to the right is three floats on and no channel is ever taken apart. Per group of four rows:
//   1. input rows are fetched with ten pixels of halo, zero outside the image (the confidence too, so that nothing
//      outside contributes): render x, target y, x^2 + y^2, x y. The SSIM needs both variances only as a sum.
//   2. the vertical window makes four rows at once: 14 loads serve 24 multiplications and 20 additions.
//   3. horizontal window, SSIM and its three derivatives, then the horizontal window over those.
//   4. twelve rows later the vertical window over the derivatives finishes four rows of gradient.
// With the first group of statistics at row y0 - 5, group j fetches input up to row y0 + 3 + 4 j and finishes
// statistics up to y0 - 2 + 4 j. Gradient rows y0 + 4 m ... + 3 need statistics from y0 - 5 + 4 m to y0 + 8 + 4 m,
// hence j = m + 3: of both the input and the derivatives exactly 16 rows are alive.

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "oraclegs/loss/photometric_kernel.cpp"
#include "oraclegs/core/hwy_targets.h"
// clang-format off: foreach_target must come before the other Highway headers
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/highway.h>

#include <algorithm>
#include <cstring>

#include "oraclegs/core/simd/lanes-inl.h"
#include "oraclegs/loss/photometric_kernel.h"
#include "oraclegs/loss/ssim_window.h"
// After the lanes, whose functions it calls.
#include "oraclegs/loss/ssim_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace oraclegs::HWY_NAMESPACE {
using photometric::Images;
using photometric::kGroup;
using photometric::kRadius;
using photometric::kRingRows;
using photometric::kStride;
using photometric::kTaps;
using photometric::Scratch;
using photometric::Tile;
using photometric::TileSums;

inline constexpr int kSlots = kRingRows - 1;  // mask from a row's number to its place in a ring
inline constexpr int kGradientLag = 3;        // groups
inline constexpr int kGroupInputs = kGroup + kTaps - 1;

HWY_INLINE constexpr float Tap(int k) {
  return static_cast<float>(kSsimWindow[k < kRadius ? kRadius - k : k - kRadius]);
}

/// Floats rounded up to whole vectors.
HWY_INLINE constexpr int WholeVectors(int n) { return (n + kLanes - 1) / kLanes * kLanes; }

/// Writes one image row of the tile with its halo into `out`, zero outside the image.
HWY_INLINE void CopyColumns(const float* HWY_RESTRICT row, int width, const Tile& tile, float* HWY_RESTRICT out) {
  const int left = tile.x0 - 2 * kRadius, right = tile.x1 + 2 * kRadius;
  const int begin = std::max(left, 0), end = std::min(right, width);
  std::fill_n(out, 3 * (begin - left), 0.f);
  std::memcpy(out + 3 * (begin - left), row + 3 * static_cast<int64_t>(begin), sizeof(float) * 3 * (end - begin));
  std::fill_n(out + 3 * (end - left), WholeVectors(3 * (right - left)) - 3 * (end - left), 0.f);
}

/// Writes one confidence row of the tile with its halo into `out`, once for each channel, zero outside the image.
HWY_INLINE void RepeatConfidence(const float* HWY_RESTRICT row, int width, const Tile& tile, float* HWY_RESTRICT out) {
  const FloatTag d;
  const int left = tile.x0 - 2 * kRadius, right = tile.x1 + 2 * kRadius;
  const int begin = std::max(left, 0), end = std::min(right, width);
  std::fill_n(out, 3 * (begin - left), 0.f);
  int x = begin;
  if (row == nullptr) {
    std::fill_n(out + 3 * (begin - left), 3 * (end - begin), 1.f);
    x = end;
  }
  for (; x + kLanes <= end; x += kLanes) {
    const FloatVec u = hn::LoadU(d, row + x);
    hn::StoreInterleaved3(u, u, u, d, out + 3 * (x - left));
  }
  for (; x < end; ++x) std::fill_n(out + 3 * (x - left), 3, row[x]);
  std::fill_n(out + 3 * (end - left), WholeVectors(3 * (right - left)) - 3 * (end - left), 0.f);
}

/// Step 1 for row y of the images.
HWY_INLINE void FetchRow(const Images& images, const Tile& tile, int y, int slot, Scratch* HWY_RESTRICT s) {
  const FloatTag d;
  const int columns = WholeVectors(3 * (tile.x1 - tile.x0 + 4 * kRadius));
  if (y < 0 || y >= images.height) {
    for (auto& plane : s->input) std::fill_n(plane[slot], columns, 0.f);
    return;
  }
  const int64_t row = static_cast<int64_t>(y) * images.width;
  float* HWY_RESTRICT xs = s->input[Scratch::kRender][slot];
  float* HWY_RESTRICT ys = s->input[Scratch::kTarget][slot];
  CopyColumns(images.render + 3 * row, images.width, tile, xs);
  CopyColumns(images.target + 3 * row, images.width, tile, ys);
  RepeatConfidence(images.confidence == nullptr ? nullptr : images.confidence + row, images.width, tile,
                   s->input[Scratch::kConfidence][slot]);
  for (int i = 0; i < columns; i += kLanes) {
    const FloatVec x = hn::Load(d, xs + i), y_value = hn::Load(d, ys + i);
    hn::Store(hn::MulAdd(x, x, hn::Mul(y_value, y_value)), d, s->input[Scratch::kSquares][slot] + i);
    hn::Store(hn::Mul(x, y_value), d, s->input[Scratch::kProduct][slot] + i);
  }
}

/// sum_k Tap(k) at(k). The window is symmetric, so pairs are added first: half as many multiplications, beside which
/// many processors can add.
template <class At>
HWY_INLINE FloatVec WindowSum(const At& at) {
  const FloatTag d;
  // Two sums, for shorter dependency chains.
  FloatVec even = hn::Mul(at(kRadius), hn::Set(d, Tap(kRadius)));
  FloatVec odd = hn::Mul(hn::Add(at(0), at(kTaps - 1)), hn::Set(d, Tap(0)));
  HWY_UNROLL(2)
  for (int k = 1; k < kRadius; k += 2) {
    even = hn::MulAdd(hn::Add(at(k), at(kTaps - 1 - k)), hn::Set(d, Tap(k)), even);
    odd = hn::MulAdd(hn::Add(at(k + 1), at(kTaps - 2 - k)), hn::Set(d, Tap(k + 1)), odd);
  }
  return hn::Add(even, odd);
}

/// Applies the window down the columns: out[r] = sum_k Tap(k) in[r + k], kGroup rows at once.
HWY_INLINE void FilterColumns(const float* const* in, int i, FloatVec* out) {
  const FloatTag d;
  FloatVec rows[kGroupInputs];
  for (int n = 0; n < kGroupInputs; ++n) rows[n] = hn::LoadU(d, in[n] + i);
  HWY_UNROLL(4)
  for (int r = 0; r < kGroup; ++r) out[r] = WindowSum([&](int k) HWY_ATTR { return rows[r + k]; });
}

#if HWY_TARGET <= HWY_AVX3
/// Lanes n to n + 15 of neighboring vectors.
template <int n>
HWY_INLINE FloatVec LanesFrom(const __m512i* vectors) {
  const __m512i shifted = _mm512_alignr_epi32(vectors[n / 16 + 1], vectors[n / 16], n % 16);
  return FloatVec{_mm512_castsi512_ps(shifted)};
}
#endif

/// Applies the window along a row of interleaved pixels: sum_k Tap(k) in[i + 3 k], `in` at a whole vector.
HWY_INLINE FloatVec FilterRow(const float* HWY_RESTRICT in) {
  const FloatTag d;
#if HWY_TARGET <= HWY_AVX3
  // Nearly every load at an odd offset would cross a cache line and take twice as long as a shift of two vectors.
  const __m512i vectors[3] = {_mm512_load_si512(in), _mm512_load_si512(in + 16), _mm512_load_si512(in + 32)};
  const FloatVec at[kTaps] = {LanesFrom<0>(vectors),  LanesFrom<3>(vectors),  LanesFrom<6>(vectors),
                              LanesFrom<9>(vectors),  LanesFrom<12>(vectors), LanesFrom<15>(vectors),
                              LanesFrom<18>(vectors), LanesFrom<21>(vectors), LanesFrom<24>(vectors),
                              LanesFrom<27>(vectors), LanesFrom<30>(vectors)};
  return WindowSum([&](int k) HWY_ATTR { return at[k]; });
#else
  return WindowSum([&](int k) HWY_ATTR { return hn::LoadU(d, in + 3 * k); });
#endif
}

/// Pointers to kGroupInputs rows of a ring, from the row numbered `first`.
HWY_INLINE void RingRows(const float (*ring)[kStride], int first, const float** rows) {
  for (int n = 0; n < kGroupInputs; ++n) rows[n] = ring[(first + n) & kSlots];
}

/// Step 2: all planes of the group whose window starts at ring row `first`.
HWY_INLINE void FilterGroup(int columns, int first, Scratch* HWY_RESTRICT s) {
  const FloatTag d;
  for (int plane = 0; plane < Scratch::kFiltered; ++plane) {
    const float* rows[kGroupInputs];
    RingRows(s->input[plane], first, rows);
    for (int i = 0; i < columns; i += kLanes) {
      FloatVec out[kGroup];
      FilterColumns(rows, i, out);
      for (int r = 0; r < kGroup; ++r) hn::Store(out[r], d, s->vertical[plane][r] + i);
    }
  }
}

/// Step 3, first half: the SSIM of row r of the group and dL/d(mean, variance, covariance) of its windows. `u` is the
/// confidence of the first column.
HWY_INLINE void StatisticsRow(int columns, int r, const float* HWY_RESTRICT u, float dssim_scale,
                              Scratch* HWY_RESTRICT s) {
  const FloatTag d;
  const FloatVec upstream = hn::Set(d, -2.f * dssim_scale);
  for (int i = 0; i < columns; i += kLanes) {
    const SsimPoint<Lanes> point = EvaluateSsim(SsimMoments<Lanes>{
        FilterRow(s->vertical[Scratch::kRender][r] + i), FilterRow(s->vertical[Scratch::kTarget][r] + i),
        FilterRow(s->vertical[Scratch::kSquares][r] + i), FilterRow(s->vertical[Scratch::kProduct][r] + i)});
    const FloatVec g = hn::Mul(upstream, hn::LoadU(d, u + i));
    hn::Store(point.ssim.v, d, s->ssim + i);
    hn::Store(hn::Mul(g, point.mean.v), d, s->coefficient[Scratch::kMean] + i);
    hn::Store(hn::Mul(g, point.variance.v), d, s->coefficient[Scratch::kVariance] + i);
    hn::Store(hn::Mul(g, point.covariance.v), d, s->coefficient[Scratch::kCovariance] + i);
  }
}

/// Adds a finished row's own pixels to the sums. `center` is the row's place in the input ring.
HWY_INLINE void AddRow(int columns, int center, const Scratch& s, TileSums* sums) {
  const FloatTag d;
  const float* HWY_RESTRICT x = s.input[Scratch::kRender][center] + 6 * kRadius;
  const float* HWY_RESTRICT y = s.input[Scratch::kTarget][center] + 6 * kRadius;
  const float* HWY_RESTRICT u = s.input[Scratch::kConfidence][center] + 6 * kRadius;
  const float* HWY_RESTRICT ssim = s.ssim + 3 * kRadius;
  FloatVec l1 = hn::Zero(d), dssim = hn::Zero(d);
  for (int i = 0; i < columns; i += kLanes) {
    const auto mine = hn::FirstN(d, static_cast<size_t>(columns - i));
    const FloatVec weight = hn::IfThenElseZero(mine, hn::LoadU(d, u + i));
    const FloatVec away = hn::IfThenElseZero(mine, hn::Sub(hn::Set(d, 1.f), hn::LoadU(d, ssim + i)));
    l1 = hn::MulAdd(hn::Abs(hn::Sub(hn::LoadU(d, x + i), hn::LoadU(d, y + i))), weight, l1);
    dssim = hn::MulAdd(away, weight, dssim);
  }
  sums->l1 += static_cast<double>(hn::GetLane(hn::SumOfLanes(d, l1)));
  sums->dssim += static_cast<double>(hn::GetLane(hn::SumOfLanes(d, dssim)));
}

/// Step 3 for row y. `row` counts from the first row of statistics, y0 - kRadius.
HWY_INLINE void FinishRow(const Images& images, const Tile& tile, int row, Scratch* HWY_RESTRICT s, TileSums* sums) {
  const FloatTag d;
  const int own = 3 * (tile.x1 - tile.x0), y = tile.y0 - kRadius + row;
  const int center = (row + kRadius) & kSlots;
  StatisticsRow(own + 6 * kRadius, row % kGroup, s->input[Scratch::kConfidence][center] + 3 * kRadius,
                images.dssim_scale, s);
  if (y >= tile.y0 && y < tile.y1) {
    AddRow(own, center, *s, sums);
    if (images.ssim != nullptr) {
      float* out = images.ssim + 3 * (static_cast<int64_t>(y) * images.width + tile.x0);
      std::memcpy(out, s->ssim + 3 * kRadius, sizeof(float) * own);
    }
  }
  if (images.grad == nullptr) return;
  for (int c = 0; c < Scratch::kCoefficients; ++c) {
    float* HWY_RESTRICT out = s->backward[c][row & kSlots];
    for (int i = 0; i < own; i += kLanes) hn::Store(FilterRow(s->coefficient[c] + i), d, out + i);
  }
}

/// dL/d(render) of kGroup rows at one vector of columns, from the derivatives and the input itself.
HWY_INLINE void GradientVector(const Scratch& s, const float* const (*rows)[kGroupInputs], int first, int i,
                               float l1_scale, FloatVec* out) {
  const FloatTag d;
  FloatVec variance[kGroup], covariance[kGroup];
  FilterColumns(rows[Scratch::kMean], i, out);
  FilterColumns(rows[Scratch::kVariance], i, variance);
  FilterColumns(rows[Scratch::kCovariance], i, covariance);
  for (int r = 0; r < kGroup; ++r) {
    const int slot = (first + 2 * kRadius + r) & kSlots, column = i + 6 * kRadius;
    const FloatVec x = hn::LoadU(d, s.input[Scratch::kRender][slot] + column);
    const FloatVec y = hn::LoadU(d, s.input[Scratch::kTarget][slot] + column);
    const FloatVec u = hn::LoadU(d, s.input[Scratch::kConfidence][slot] + column);
    const FloatVec step = hn::Mul(u, hn::Set(d, l1_scale));
    const FloatVec l1 = hn::IfThenElseZero(hn::Ne(x, y), hn::CopySign(step, hn::Sub(x, y)));
    out[r] = hn::MulAdd(x, variance[r], hn::MulAdd(y, covariance[r], hn::Add(out[r], l1)));
  }
}

/// Step 4: the gradient of rows y0 + first ... + kGroup - 1 that belong to the tile.
HWY_INLINE void GradientGroup(const Images& images, const Tile& tile, int first, const Scratch& s) {
  const FloatTag d;
  const float* rows[Scratch::kCoefficients][kGroupInputs];
  for (int c = 0; c < Scratch::kCoefficients; ++c) RingRows(s.backward[c], first, rows[c]);
  const int own = 3 * (tile.x1 - tile.x0), count = std::min(kGroup, tile.y1 - tile.y0 - first);
  float* out = images.grad + 3 * ((static_cast<int64_t>(tile.y0) + first) * images.width + tile.x0);
  for (int i = 0; i < own; i += kLanes) {
    FloatVec grad[kGroup];
    GradientVector(s, rows, first, i, images.l1_scale, grad);
    for (int r = 0; r < count; ++r) {
      float* to = out + 3 * static_cast<int64_t>(r) * images.width + i;
      if (own - i >= kLanes) {
        hn::StoreU(grad[r], d, to);
      } else {
        HWY_ALIGN float last[kLanes];
        hn::Store(grad[r], d, last);
        std::memcpy(to, last, sizeof(float) * (own - i));
      }
    }
  }
}

TileSums RunTileKernel(const Images& images, const Tile& tile, Scratch* s) {
  TileSums sums;
  const int columns = 3 * (tile.x1 - tile.x0 + 4 * kRadius);
  const int groups = (tile.y1 - tile.y0 + kGroup - 1) / kGroup + kGradientLag;
  int fetched = 0;  // rows in the ring, counted from y0 - 2 kRadius
  for (int group = 0; group < groups; ++group) {
    const int first = group * kGroup;
    for (; fetched < first + kGroupInputs; ++fetched) {
      FetchRow(images, tile, tile.y0 - 2 * kRadius + fetched, fetched & kSlots, s);
    }
    FilterGroup(columns, first, s);
    for (int row = first; row < first + kGroup; ++row) FinishRow(images, tile, row, s, &sums);
    if (images.grad != nullptr && group >= kGradientLag) {
      GradientGroup(images, tile, (group - kGradientLag) * kGroup, *s);
    }
  }
  return sums;
}

}  // namespace oraclegs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace oraclegs {
HWY_EXPORT(RunTileKernel);

namespace photometric {

TileSums RunTile(const Images& images, const Tile& tile, Scratch* scratch) {
  return HWY_DYNAMIC_DISPATCH(RunTileKernel)(images, tile, scratch);
}

}  // namespace photometric
}  // namespace oraclegs
#endif
