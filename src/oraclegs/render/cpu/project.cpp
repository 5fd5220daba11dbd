// Per-Gaussian work, forward and backward: the shared mathematics of splat_math-inl.h with one Gaussian a lane.

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "oraclegs/render/cpu/project.cpp"
#include "oraclegs/core/hwy_targets.h"
// clang-format off: foreach_target must come before the other Highway headers
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/highway.h>

#include <cmath>
#include <cstring>

#include "oraclegs/core/simd/lanes-inl.h"
#include "oraclegs/core/simd/rows-inl.h"
#include "oraclegs/render/blend_math-inl.h"
#include "oraclegs/render/color_math-inl.h"
#include "oraclegs/render/cpu/kernels.h"
#include "oraclegs/render/splat_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace oraclegs::HWY_NAMESPACE {

HWY_INLINE RawSplat<Lanes> LoadRaw(const GaussianParameters& in, int64_t i, int count) {
  Lanes mean[3], scale[3], quat[4], logit[1];
  LoadRows<3>(in.means + 3 * i, count, mean);
  LoadRows<3>(in.log_scales + 3 * i, count, scale);
  LoadRows<4>(in.quats + 4 * i, count, quat);
  LoadRows<1>(in.opacity_logits + i, count, logit);
  return {{mean[0], mean[1], mean[2]}, {scale[0], scale[1], scale[2]}, quat[0], quat[1], quat[2], quat[3], logit[0]};
}

/// The lanes' SH rows, one vector a coefficient and channel.
struct ShColumns {
  FloatVec v[kShFloats];

  static HWY_INLINE int Tiles(int coefficients) { return (3 * coefficients + kLanes - 1) / kLanes; }
  HWY_INLINE void Load(const float* sh, int64_t i, int count, int coefficients) {
    LoadWideRows(sh + i * kShFloats, kShFloats, count, Tiles(coefficients), v);
  }
  HWY_INLINE Lanes Get(int k, int c) const { return v[3 * k + c]; }
};

/// Stores the tile rectangles of the ellipses about the projected centers; empty where not visible or outside the
/// image. Returns whether any is not empty.
HWY_INLINE bool StoreRects(const SplatCamera<float>& camera, const ProjectedSplat<Lanes>& p,
                           const Ellipse<Lanes>& ellipse, int count, TileRect* rects) {
  const IntTag di;
  PixelSpan<Lanes> span[2];
  const LanesMask in_x = SpanAlong(p.mx, ellipse.half_x, camera.width, &span[0]);
  const LanesMask in_y = SpanAlong(p.my, ellipse.half_y, camera.height, &span[1]);
  const LanesMask visible = And(IsVisible(p), And(in_x, in_y));
  HWY_ALIGN int32_t first[2][kLanes], last[2][kLanes];  // tiles
  for (int axis = 0; axis < 2; ++axis) {
    const auto tile = [&](Lanes pixel) HWY_ATTR { return hn::ShiftRight<4>(hn::ConvertTo(di, pixel.v)); };
    hn::Store(tile(span[axis].first), di, first[axis]);
    hn::Store(hn::Add(tile(span[axis].last), hn::Set(di, 1)), di, last[axis]);
  }
  static_assert(kTile == 1 << 4);
  HWY_ALIGN int32_t seen[kLanes];
  hn::Store(hn::IfThenElseZero(hn::RebindMask(di, visible.m), hn::Set(di, 1)), di, seen);
  bool any = false;
  for (int lane = 0; lane < count; ++lane) {
    const auto value = [&](int32_t tile) { return static_cast<uint16_t>(tile * seen[lane]); };
    rects[lane] = {value(first[0][lane]), value(first[1][lane]), value(last[0][lane]), value(last[1][lane])};
    any |= seen[lane] != 0;
  }
  return any;
}

HWY_INLINE void StoreSplats(const Lanes* columns, int count, cpu::LineSplat* splats) {
  constexpr int kStride = sizeof(cpu::LineSplat) / sizeof(float), kTiles = (cpu::kSplatFields + kLanes - 1) / kLanes;
  FloatVec rows[kTiles * kLanes];
  for (int field = 0; field < kTiles * kLanes; ++field) {
    rows[field] = field < cpu::kSplatFields ? columns[field].v : hn::Zero(FloatTag());
  }
  StoreWideRows(rows, kStride, count, kTiles, reinterpret_cast<float*>(splats));
}

HWY_NOINLINE void ProjectSplats(const cpu::ProjectInput& in, int64_t begin, int64_t end, cpu::LineSplat* splats,
                                TileRect* rects) {
  const SplatCamera<float> camera = in.camera;
  const int coefficients = (camera.sh_degree + 1) * (camera.sh_degree + 1);
  for (int64_t i = begin; i < end; i += kLanes) {
    const int count = static_cast<int>(std::min<int64_t>(kLanes, end - i));
    const RawSplat<Lanes> raw = LoadRaw(in.gaussians, i, count);
    const SplatChain<Lanes> chain = EvaluateChain(raw, camera);
    ProjectedSplat<Lanes> p = Project(chain, camera);
    if (in.gaussians.opacity_factors != nullptr) {
      Lanes factor[1];
      LoadRows<1>(in.gaussians.opacity_factors + i, count, factor);
      p.opacity = p.opacity * factor[0];
    }

    const Ellipse<Lanes> ellipse = EllipseOf(p);
    if (!StoreRects(camera, p, ellipse, count, rects + i)) continue;

    Lanes basis[kMaxShTerms], inv_distance;
    ShBasis(camera.sh_degree, ViewDirection(raw.mean, camera, &inv_distance), basis);
    ShColumns sh;
    sh.Load(in.gaussians.sh, i, count, coefficients);
    Lanes columns[cpu::kSplatFields];
    SplatFields(p, ellipse.log_opacity, RawColor(sh, basis, coefficients), columns);
    StoreSplats(columns, count, splats + i);
  }
}

/// Sums over a Gaussian's records, four floats each. A record's moments are about its tile's center. With (dx, dy) from
/// the Gaussian to that center, moments about the Gaussian follow by expanding (x + dx)(y + dy): they need the sums of
/// the moments, of moments times dx and dy, and of the zeroth one times the three products.
enum MomentSums { kSums0, kSums4, kSumsDx, kSumsDy, kSumsProducts, kSumsColor, kMomentSums };
inline constexpr int kMomentRow = 32;  // floats; a whole number of vectors
static_assert(4 * kMomentSums <= kMomentRow && kMomentRow % kLanes == 0);

/// Four floats, in the compiler's terms: Highway has no vectors of that size on targets of one lane.
using Quad [[gnu::vector_size(16)]] = float;

HWY_INLINE Quad LoadQuad(const float* from) {
  Quad q;
  std::memcpy(&q, from, sizeof(q));
  return q;
}

/// Tile numbers to columns and rows without a division.
class TileColumns {
 public:
  explicit TileColumns(int tiles_x)
      : tiles_x_(static_cast<uint32_t>(tiles_x)), inverse_((uint64_t{1} << kShift) / tiles_x_ + 1) {}
  /// Exact while tile * tiles_x < 2^40, far above the largest image's 2^33: inverse_ is too large by one at most.
  HWY_INLINE uint32_t Row(uint32_t tile) const { return static_cast<uint32_t>(tile * inverse_ >> kShift); }
  HWY_INLINE uint32_t Column(uint32_t tile, uint32_t row) const { return tile - row * tiles_x_; }

 private:
  static constexpr int kShift = 40;
  uint32_t tiles_x_;
  uint64_t inverse_;
};

/// Prefetches the inputs of Gaussian i's gradient, while those before it are processed: its records were written past
/// the caches, and the prefetcher does not catch so few rows of colors.
HWY_INLINE void PrefetchGaussian(const cpu::ProjectInput& in, const cpu::GradInput& grads, int64_t i) {
  constexpr int kLocality = 2;    // the second-level cache: too much for the first
  constexpr int kRecords = 3;     // most Gaussians have no more
  constexpr int kCacheLine = 16;  // floats
  const float* records = grads.records + static_cast<int64_t>(grads.ranges[i].begin) * cpu::kGradStride;
  for (int k = 0; k < kRecords; ++k) __builtin_prefetch(records + k * cpu::kGradStride, 0, kLocality);
  const float* sh = in.gaussians.sh + i * kShFloats;
  for (int k = 0; k < kShFloats; k += kCacheLine) __builtin_prefetch(sh + k, 0, kLocality);
}

/// Writes kMomentSums quads of Gaussian i to `sums`.
HWY_INLINE void SumRecords(const cpu::GradInput& grads, const TileColumns& columns, int64_t i, float* sums) {
  const cpu::PairRange range = grads.ranges[i];
  const float to_x = static_cast<float>(kTile / 2) - grads.splats[i].mx;
  const float to_y = static_cast<float>(kTile / 2) - grads.splats[i].my;
  Quad sum[kMomentSums] = {};
  for (uint32_t j = range.begin; j < range.begin + range.count; ++j) {
    const float* HWY_RESTRICT s = grads.records + static_cast<int64_t>(j) * cpu::kGradStride;
    const uint32_t tile = grads.pair_tile[j], row = columns.Row(tile);
    const float dx = static_cast<float>(static_cast<int>(columns.Column(tile, row) * kTile)) + to_x;
    const float dy = static_cast<float>(static_cast<int>(row * kTile)) + to_y;
    const Quad first = LoadQuad(s);
    const Quad offsets = {dx, dy, dy, 0}, factors = {dx * s[0], dx * s[0], dy * s[0], 0};
    sum[kSums0] += first;
    sum[kSums4] += LoadQuad(s + 4);
    sum[kSumsDx] += dx * first;
    sum[kSumsDy] += dy * first;
    sum[kSumsProducts] += offsets * factors;
    sum[kSumsColor] += LoadQuad(s + 8);
  }
  std::memcpy(sums, sum, sizeof(sum));
}

/// The sums of BlendTileBackward's records about the Gaussians, one per lane, from rows of kMomentRow floats.
HWY_INLINE BlendSums<Lanes> CombineSums(const float* rows) {
  FloatVec v[kMomentRow];
  LoadWideRows(rows, kMomentRow, kLanes, kMomentRow / kLanes, v);
  const auto at = [&](int sums, int k) HWY_ATTR { return Lanes(v[4 * sums + k]); };
  const Lanes two(2.f);
  BlendSums<Lanes> m;
  m.h = at(kSums0, 0);
  m.x = at(kSums0, 1) + at(kSumsDx, 0);
  m.y = at(kSums0, 2) + at(kSumsDy, 0);
  m.xx = at(kSums0, 3) + two * at(kSumsDx, 1) + at(kSumsProducts, 0);
  m.xy = at(kSums4, 0) + at(kSumsDx, 2) + at(kSumsDy, 1) + at(kSumsProducts, 1);
  m.yy = at(kSums4, 1) + two * at(kSumsDy, 2) + at(kSumsProducts, 2);
  m.r = at(kSumsColor, 0), m.g = at(kSumsColor, 1), m.b = at(kSumsColor, 2), m.inv_z = at(kSumsColor, 3);
  return m;
}

HWY_INLINE void ZeroRows(const GaussianRows& out, int count, int coefficients) {
  std::memset(out.means, 0, sizeof(float) * 3 * count);
  std::memset(out.log_scales, 0, sizeof(float) * 3 * count);
  std::memset(out.quats, 0, sizeof(float) * 4 * count);
  std::memset(out.opacity_logits, 0, sizeof(float) * count);
  for (int lane = 0; lane < count; ++lane) {
    std::memset(out.sh + lane * kShFloats, 0, sizeof(float) * 3 * coefficients);
  }
}

/// Neighboring Gaussians in the lanes of one vector.
struct LaneGroup {
  int64_t first;   ///< row of lane 0
  int count;       ///< rows; later lanes repeat the last
  LanesMask seen;  ///< lanes that reached a pixel; elsewhere results may be undefined and must come out as zero
};

/// Stores the gradient of SH; `rows` begin with lane 0's.
HWY_INLINE void StoreShGradient(const Lanes* basis, const Vec3<Lanes>& g, const LaneGroup& group, int coefficients,
                                float* rows) {
  const Lanes zero(0.f);
  FloatVec columns[kShFloats];
  for (int k = 0; k < coefficients; ++k) {
    const Lanes b = Select(group.seen, basis[k], zero);  // the direction of an unseen one may be undefined
    columns[3 * k] = (b * g.x).v;
    columns[3 * k + 1] = (b * g.y).v;
    columns[3 * k + 2] = (b * g.z).v;
  }
  const int whole = 3 * coefficients / kLanes, rest = 3 * coefficients % kLanes;
  StoreWideRows(columns, kShFloats, group.count, whole, rows);
  if (rest == 0) return;
  // Columns above the active degree must not be written.
  HWY_ALIGN float buffer[kLanes * kLanes];
  FloatVec* last = columns + whole * kLanes;
  for (int c = rest; c < kLanes; ++c) last[c] = zero.v;
  StoreWideRows(last, kLanes, kLanes, 1, buffer);
  for (int lane = 0; lane < group.count; ++lane) {
    std::memcpy(rows + lane * kShFloats + whole * kLanes, buffer + lane * kLanes, sizeof(float) * rest);
  }
}

/// Stores gradient rows of SH, from lane 0's on. Returns the part of d/d(mean) that comes through the viewing direction
/// (docs/method.md#color-gradient).
HWY_INLINE Vec3<Lanes> ShBackward(const cpu::ProjectInput& in, const Vec3<Lanes>& mean, const Vec3<Lanes>& g_color,
                                  const LaneGroup& group, float* sh_rows) {
  const int coefficients = (in.camera.sh_degree + 1) * (in.camera.sh_degree + 1);
  ShColumns sh;
  sh.Load(in.gaussians.sh, group.first, group.count, coefficients);
  const auto store = [&](const Lanes* basis, const Vec3<Lanes>& g)
                         HWY_ATTR { StoreShGradient(basis, g, group, coefficients, sh_rows); };
  return ColorBackward(in.camera, mean, sh, g_color, store);
}

/// Destination of one vector's screen gradients.
struct ScreenLanes {
  const cpu::GradInput& grads;
  int64_t first;  ///< Gaussian of lane 0
  int count;
};
HWY_INLINE void AddScreenGradients(const ProjectedGrad<Lanes>& g, const SplatCamera<float>& camera,
                                   const ScreenLanes& lanes) {
  const FloatTag d;
  HWY_ALIGN float x[kLanes], y[kLanes];
  hn::Store((g.mx * Lanes(0.5f * static_cast<float>(camera.width))).v, d, x);
  hn::Store((g.my * Lanes(0.5f * static_cast<float>(camera.height))).v, d, y);
  for (int lane = 0; lane < lanes.count; ++lane) {
    const int64_t i = lanes.first + lane;
    if (lanes.grads.ranges[i].count == 0) continue;
    lanes.grads.screen_sums[i] += std::sqrt(x[lane] * x[lane] + y[lane] * y[lane]);
    lanes.grads.screen_views[i] += 1;
  }
}

template <bool kWatchesCamera>
HWY_NOINLINE void BackwardOfRows(const cpu::ProjectInput& in, const cpu::GradInput& grads, int64_t begin, int64_t end,
                                 const GaussianRows& out) {
  const FloatTag d;
  const SplatCamera<float> camera = in.camera;
  const int coefficients = (camera.sh_degree + 1) * (camera.sh_degree + 1);
  const TileColumns tile_columns(camera.tiles_x);
  HWY_ALIGN float sums[kMomentRow * kLanes] = {};
  Lanes camera_sums[kCameraSums];
  if constexpr (kWatchesCamera) std::fill_n(camera_sums, kCameraSums, Lanes(0.f));
  for (int64_t i = begin; i < end; i += kLanes) {
    const int count = static_cast<int>(std::min<int64_t>(kLanes, end - i));
    const GaussianRows rows = out.From(i - begin);
    bool any = false;
    for (int lane = 0; lane < count; ++lane) any |= grads.ranges[i + lane].count > 0;
    if (!any) {
      ZeroRows(rows, count, coefficients);
      continue;
    }
    HWY_ALIGN float seen[kLanes] = {};
    for (int lane = 0; lane < count; ++lane) {
      if (i + kLanes + lane < end) PrefetchGaussian(in, grads, i + kLanes + lane);
      SumRecords(grads, tile_columns, i + lane, sums + lane * kMomentRow);
      seen[lane] = grads.ranges[i + lane].count > 0 ? 1.f : 0.f;
    }
    const BlendSums<Lanes> m = CombineSums(sums);

    const RawSplat<Lanes> raw = LoadRaw(in.gaussians, i, count);
    const SplatChain<Lanes> chain = EvaluateChain(raw, camera);
    const ProjectedSplat<Lanes> p = Project(chain, camera);
    const ProjectedGrad<Lanes> g = ProjectedGradOf(p, m);
    if (grads.screen_sums) AddScreenGradients(g, camera, {grads, i, count});
    const CameraSpaceGrad<Lanes> space_grad = ProjectBackward(chain, camera, g);
    const RawGrad<Lanes> raw_grad = RawBackward(chain, camera, space_grad);
    const LaneGroup group{i, count, Lanes(hn::Load(d, seen)) > Lanes(0.f)};
    const Vec3<Lanes> from_color = ShBackward(in, raw.mean, {m.r, m.g, m.b}, group, rows.sh);

    // Lanes without records hold zeros or, behind the camera, whatever a division by zero gave.
    const auto keep = [&](Lanes value) HWY_ATTR { return Select(group.seen, value, Lanes(0.f)); };
    const Lanes means[3] = {keep(raw_grad.mean.x + from_color.x), keep(raw_grad.mean.y + from_color.y),
                            keep(raw_grad.mean.z + from_color.z)};
    const Lanes scales[3] = {keep(raw_grad.log_scale.x), keep(raw_grad.log_scale.y), keep(raw_grad.log_scale.z)};
    const Lanes quats[4] = {keep(raw_grad.qw), keep(raw_grad.qx), keep(raw_grad.qy), keep(raw_grad.qz)};
    const Lanes logit[1] = {keep(raw_grad.logit)};
    StoreRows<3>(means, count, rows.means);
    StoreRows<3>(scales, count, rows.log_scales);
    StoreRows<4>(quats, count, rows.quats);
    StoreRows<1>(logit, count, rows.opacity_logits);
    if constexpr (kWatchesCamera) {
      const CameraTerms<Lanes> terms =
          CameraBackward(chain, camera, g, space_grad, Vec3<Lanes>{means[0], means[1], means[2]});
      for (int k = 0; k < kCameraSums; ++k) camera_sums[k] = camera_sums[k] + keep(terms.of[k]);
    }
  }
  if constexpr (kWatchesCamera) {
    for (int k = 0; k < kCameraSums; ++k) grads.camera_sums[k] = hn::GetLane(hn::SumOfLanes(d, camera_sums[k].v));
  }
}

HWY_NOINLINE void ProjectSplatsBackward(const cpu::ProjectInput& in, const cpu::GradInput& grads, int64_t begin,
                                        int64_t end, const GaussianRows& out) {
  return grads.camera_sums != nullptr ? BackwardOfRows<true>(in, grads, begin, end, out)
                                      : BackwardOfRows<false>(in, grads, begin, end, out);
}

}  // namespace oraclegs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace oraclegs {
HWY_EXPORT(ProjectSplats);
HWY_EXPORT(ProjectSplatsBackward);

namespace cpu {
void ProjectSplats(const ProjectInput& in, int64_t begin, int64_t end, LineSplat* splats, TileRect* rects) {
  HWY_DYNAMIC_DISPATCH(ProjectSplats)(in, begin, end, splats, rects);
}
void ProjectSplatsBackward(const ProjectInput& in, const GradInput& grads, int64_t begin, int64_t end,
                           const GaussianRows& out) {
  HWY_DYNAMIC_DISPATCH(ProjectSplatsBackward)(in, grads, begin, end, out);
}
}  // namespace cpu
}  // namespace oraclegs
#endif
