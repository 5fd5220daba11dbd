// A projected Gaussian as the blend loop takes it, its box in the image, and the gradients of the projection from the
// loop's sums (docs/method.md#blending). F as in splat_math-inl.h.

#if defined(ORACLEGS_RENDER_BLEND_MATH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ORACLEGS_RENDER_BLEND_MATH_INL_H_
#undef ORACLEGS_RENDER_BLEND_MATH_INL_H_
#else
#define ORACLEGS_RENDER_BLEND_MATH_INL_H_
#endif

#include "oraclegs/core/device_macros.h"
#include "oraclegs/core/simd/rounding_ops-inl.h"
#include "oraclegs/core/simd/scalar_ops-inl.h"
#include "oraclegs/render/constants.h"
#include "oraclegs/render/splat_math-inl.h"

#if !defined(__CUDACC__)
#include <hwy/highway.h>
HWY_BEFORE_NAMESPACE();
namespace oraclegs::HWY_NAMESPACE {
#else
namespace oraclegs::cuda {
#endif

/// The ellipse alpha >= 1/255. Meaningless where not IsVisible.
template <class F>
struct Ellipse {
  F log_opacity;
  F half_x, half_y;  ///< half size of the bounding box, px
};

template <class F>
ORACLEGS_HD inline Ellipse<F> EllipseOf(const ProjectedSplat<F>& p) {
  // alpha >= 1/255 inside |d|_K <= k, k^2 = 2 ln(255 o'), whose bounding box is k sqrt(diag(cov)).
  const F log_opacity = Log(Max(p.opacity, F(1e-30f)));
  const F k2 = Max(F(2.f) * (log_opacity + F(kLog255)), F(0.f));
  return {log_opacity, Sqrt(k2 * p.cov_a), Sqrt(k2 * p.cov_c)};
}

template <class F>
ORACLEGS_HD inline auto IsVisible(const ProjectedSplat<F>& p) {
  return And(p.z > F(kNearPlane), p.opacity >= F(kAlphaMin));
}

/// First and last pixel along an axis, whole numbers inside the image.
template <class F>
struct PixelSpan {
  F first, last;
};

/// Computes the pixels whose centers lie in [center - half, center + half] along an axis of `size` pixels, exact but
/// for rounding, which widens them (docs/method.md#tiles-and-sorting). Returns whether there are any; NaN has none.
template <class F>
ORACLEGS_HD inline auto SpanAlong(F center, F half, int size, PixelSpan<F>* span) {
  const F slack(1e-3f);  // of a pixel: many ulp at any image size
  // Pixel centers are at halves.
  const F low = Ceil(center - half - F(0.5f) - slack), high = Floor(center + half - F(0.5f) + slack);
  const F end(static_cast<float>(size - 1)), zero(0.f);
  *span = {Max(zero, Min(low, end)), Max(zero, Min(high, end))};
  return And(And(low <= high, high >= zero), low <= end);
}

/// Writes the fields of Splat (splats.h), in their order.
template <class F>
ORACLEGS_HD inline void SplatFields(const ProjectedSplat<F>& p, F log_opacity, const Vec3<F>& color, F* fields) {
  const F half(0.5f * kLog2E), zero(0.f);
  fields[0] = p.mx;
  fields[1] = p.my;
  fields[2] = Sqrt(half / p.cov_a);
  fields[3] = Sqrt(half * p.conic_c);
  fields[4] = p.conic_b / p.conic_c;
  fields[5] = F(kLog2E) * log_opacity;
  fields[6] = p.z;
  fields[7] = zero;
  fields[8] = Max(color.x, zero);
  fields[9] = Max(color.y, zero);
  fields[10] = Max(color.z, zero);
  fields[11] = F(1.f) / p.z;
}

/// Terms of the reach test of a Splat.
template <class F>
struct ReachTerms {
  F ax, by, slope, across, bound;
};

template <class F>
ORACLEGS_HD inline ReachTerms<F> ReachTermsOf(F ax, F by, F slope, F log2_opacity) {
  // The sum of squares of Splat is smallest, for a fixed dx, at dy = -slope dx; for a fixed dy at dx = across dy.
  const F tilt = by * by * slope;
  // alpha >= 1/255 <=> sum <= bound. The slack covers rounding here and in the blend loop, also of needles whose
  // center is far away.
  return {ax, by, slope, -tilt / FusedMulAdd(ax, ax, tilt * slope), log2_opacity - F(kLog2AlphaMin) + F(1e-3f)};
}

/// Whether alpha may be 1/255 between the pixel centers (x0, y0) and (x0 + span_x, y0 + span_y), which are offsets from
/// the Gaussian's center: the exact minimum of the quadratic form over that rectangle, which lies on the edge nearest
/// in x or on the one nearest in y. Fused by hand, since one kernel may count by it and another list.
template <class F>
ORACLEGS_HD inline auto Reaches(const ReachTerms<F>& r, F x0, F y0, F span_x, F span_y) {
  const F x1 = x0 + span_x, y1 = y0 + span_y, zero(0.f);
  const F near_x = Max(x0, Min(x1, zero)), near_y = Max(y0, Min(y1, zero));
  const F best_y = Max(y0, Min(y1, -r.slope * near_x)), best_x = Max(x0, Min(x1, r.across * near_y));
  const F p1 = r.ax * near_x, q1 = r.by * FusedMulAdd(r.slope, near_x, best_y);
  const F p2 = r.ax * best_x, q2 = r.by * FusedMulAdd(r.slope, best_x, near_y);
  return Min(FusedMulAdd(p1, p1, q1 * q1), FusedMulAdd(p2, p2, q2 * q2)) <= r.bound;
}

/// Sums over the pixels of a Gaussian: h = alpha dL/d(alpha), its moments by the offset (x, y) from the center to the
/// pixel, and the gradients of color and 1/z.
template <class F>
struct BlendSums {
  F h, x, y, xx, xy, yy, r, g, b, inv_z;
};

/// dL/d(projected quantities) (docs/method.md#blending-gradient, where offsets point the other way).
template <class F>
ORACLEGS_HD inline ProjectedGrad<F> ProjectedGradOf(const ProjectedSplat<F>& p, const BlendSums<F>& s) {
  ProjectedGrad<F> g;
  g.mx = p.conic_a * s.x + p.conic_b * s.y;
  g.my = p.conic_c * s.y + p.conic_b * s.x;
  g.conic_a = F(-0.5f) * s.xx;
  g.conic_b = -s.xy;
  g.conic_c = F(-0.5f) * s.yy;
  // h sums dL/d(log opacity). An opacity factor is a constant under the logarithm, so this is the derivative by the
  // opacity without it.
  g.opacity = s.h / p.opacity;
  g.inv_z = s.inv_z;
  return g;
}

}  // namespace
#if !defined(__CUDACC__)
HWY_AFTER_NAMESPACE();
#endif
#endif
