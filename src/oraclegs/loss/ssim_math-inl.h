// The structural similarity of one window and its derivatives (docs/method.md#losses). One body of code for all
// devices; F is a number type as in core/simd.

#if defined(ORACLEGS_LOSS_SSIM_MATH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ORACLEGS_LOSS_SSIM_MATH_INL_H_
#undef ORACLEGS_LOSS_SSIM_MATH_INL_H_
#else
#define ORACLEGS_LOSS_SSIM_MATH_INL_H_
#endif

#include "oraclegs/core/device_macros.h"
#include "oraclegs/core/simd/scalar_ops-inl.h"
#include "oraclegs/loss/ssim_window.h"

#if !defined(__CUDACC__)
#include <hwy/highway.h>
HWY_BEFORE_NAMESPACE();
namespace oraclegs::HWY_NAMESPACE {
#else
namespace oraclegs::cuda {
#endif

/// Means and second moments of a window; x is the render, y the target. SSIM needs only the sum of the variances.
template <class F>
struct SsimMoments {
  F x, y;
  F squares;  ///< mean of x^2 + y^2
  F product;  ///< mean of x y
};

/// S of a window. Half of its derivative by a render's pixel x of weight 1 in the window is mean + variance x +
/// covariance y, y being the target's pixel.
template <class F>
struct SsimPoint {
  F ssim, mean, variance, covariance;
};

template <class F>
ORACLEGS_HD inline SsimPoint<F> EvaluateSsim(const SsimMoments<F>& w) {
  const F two(2.f), c1(kSsimC1), c2(kSsimC2);
  const F mxy = w.x * w.y, mm = MulAdd(w.x, w.x, w.y * w.y);
  const F p = MulAdd(two, mxy, c1), q = MulAdd(two, w.product - mxy, c2);
  const F a = mm + c1, b = Max(w.squares - mm, F(0.f)) + c2;
  const F inv_ab = F(1.f) / (a * b);
  const F ssim = p * q * inv_ab;
  // 1/b - 1/a = (a - b) / (a b), and 1/b = a / (a b): one division serves all.
  const F by_my = w.y * (q - p) * inv_ab;
  const F by_mx = w.x * ssim * ((a - b) * inv_ab);
  return {ssim, by_my + by_mx, -(ssim * (a * inv_ab)), p * inv_ab};
}

}  // namespace
#if !defined(__CUDACC__)
HWY_AFTER_NAMESPACE();
#endif
#endif
