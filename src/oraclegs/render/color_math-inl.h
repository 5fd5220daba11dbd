// Color of a Gaussian from a camera and its derivative (docs/method.md#color-gradient). F as in splat_math-inl.h. `Sh`
// has the coefficients: sh.Get(k, channel) is an F.

#if defined(ORACLEGS_RENDER_COLOR_MATH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ORACLEGS_RENDER_COLOR_MATH_INL_H_
#undef ORACLEGS_RENDER_COLOR_MATH_INL_H_
#else
#define ORACLEGS_RENDER_COLOR_MATH_INL_H_
#endif

#include "oraclegs/core/device_macros.h"
#include "oraclegs/core/simd/rounding_ops-inl.h"
#include "oraclegs/core/simd/scalar_ops-inl.h"
#include "oraclegs/render/sh_math-inl.h"
#include "oraclegs/render/splat_camera.h"

#if !defined(__CUDACC__)
#include <hwy/highway.h>
HWY_BEFORE_NAMESPACE();
namespace oraclegs::HWY_NAMESPACE {
#else
namespace oraclegs::cuda {
#endif

inline constexpr int kMaxShTerms = 16;

/// Length of a loop over terms that ends at `coefficients`: on a GPU a constant, so that it is unrolled and the terms
/// stay in registers.
ORACLEGS_HD inline int LoopOverTerms([[maybe_unused]] int coefficients) {
#if defined(__CUDACC__)
  return kMaxShTerms;
#else
  return coefficients;
#endif
}

/// Unit vector from the camera to the Gaussian, and the reciprocal of its distance.
template <class F, class T>
ORACLEGS_HD inline Vec3<F> ViewDirection(const Vec3<F>& mean, const SplatCamera<T>& camera, F* inv_distance) {
  const Vec3<F> d{mean.x - F(camera.eye[0]), mean.y - F(camera.eye[1]), mean.z - F(camera.eye[2])};
  *inv_distance = F(1.f) / Sqrt(Dot(d, d));
  return {d.x * *inv_distance, d.y * *inv_distance, d.z * *inv_distance};
}

/// Color before the clamp at zero.
template <class F, class Sh>
ORACLEGS_HD inline Vec3<F> RawColor(const Sh& sh, const F* basis, int coefficients) {
  Vec3<F> c{F(0.5f), F(0.5f), F(0.5f)};
#if defined(__CUDACC__)
#pragma unroll
#endif
  for (int k = 0; k < LoopOverTerms(coefficients); ++k) {
    if (k >= coefficients) break;
    c.x = FusedMulAdd(basis[k], sh.Get(k, 0), c.x);
    c.y = FusedMulAdd(basis[k], sh.Get(k, 1), c.y);
    c.z = FusedMulAdd(basis[k], sh.Get(k, 2), c.z);
  }
  return c;
}

/// The adjoint of the clamped color, whose gradient is g_color. store(basis, g) takes the gradients of the
/// coefficients, basis_k g; it may overwrite `sh`. Returns the part of d/d(mean) that comes through the viewing
/// direction.
template <class F, class T, class Sh, class Store>
ORACLEGS_HD inline Vec3<F> ColorBackward(const SplatCamera<T>& camera, const Vec3<F>& mean, const Sh& sh,
                                         const Vec3<F>& g_color, const Store& store) {
  const int coefficients = (camera.sh_degree + 1) * (camera.sh_degree + 1);
  F basis[kMaxShTerms], weight[kMaxShTerms], inv_distance;
  const Vec3<F> direction = ViewDirection(mean, camera, &inv_distance);
  ShBasis(camera.sh_degree, direction, basis);
  const Vec3<F> color = RawColor(sh, basis, coefficients);
  const F zero(0.f);
  const Vec3<F> g{Select(color.x > zero, g_color.x, zero), Select(color.y > zero, g_color.y, zero),
                  Select(color.z > zero, g_color.z, zero)};
#if defined(__CUDACC__)
#pragma unroll
#endif
  for (int k = 1; k < LoopOverTerms(coefficients); ++k) {
    if (k >= coefficients) break;
    weight[k] = sh.Get(k, 0) * g.x + sh.Get(k, 1) * g.y + sh.Get(k, 2) * g.z;
  }
  const Vec3<F> gd = ShGradient(camera.sh_degree, direction, weight);
  store(basis, g);
  const F radial = Dot(direction, gd);
  return {(gd.x - direction.x * radial) * inv_distance, (gd.y - direction.y * radial) * inv_distance,
          (gd.z - direction.z * radial) * inv_distance};
}

}  // namespace
#if !defined(__CUDACC__)
HWY_AFTER_NAMESPACE();
#endif
#endif
