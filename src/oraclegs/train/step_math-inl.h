// The mathematics of one training step: Adam and the regularisers (docs/method.md#adam, #regularisers). One body of
// code for all devices; F is a number type as in render/splat_math-inl.h, with MulAdd and Abs.

#if defined(ORACLEGS_TRAIN_STEP_MATH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ORACLEGS_TRAIN_STEP_MATH_INL_H_
#undef ORACLEGS_TRAIN_STEP_MATH_INL_H_
#else
#define ORACLEGS_TRAIN_STEP_MATH_INL_H_
#endif

#include "oraclegs/core/device_macros.h"
#include "oraclegs/core/simd/scalar_ops-inl.h"
#include "oraclegs/render/splat_math-inl.h"
#include "oraclegs/train/constants.h"

#if !defined(__CUDACC__)
#include <hwy/highway.h>
HWY_BEFORE_NAMESPACE();
namespace oraclegs::HWY_NAMESPACE {
#else
namespace oraclegs::cuda {
#endif

/// A parameter and its moments.
template <class F>
struct AdamNumber {
  F value, m, v;
};

/// A step of Adam. rate: learning rate / (1 - beta1^t); correction2_root: 1 / sqrt(1 - beta2^t).
template <class F>
ORACLEGS_HD inline void StepNumber(F gradient, F rate, F correction2_root, AdamNumber<F>* n) {
  const F beta1(static_cast<float>(kAdamBeta1)), rest1(static_cast<float>(1 - kAdamBeta1));
  const F beta2(static_cast<float>(kAdamBeta2)), rest2(static_cast<float>(1 - kAdamBeta2));
  const F smallest(kSmallestMoment);
  n->m = MulAdd(beta1, n->m, rest1 * gradient);
  n->v = MulAdd(beta2, n->v, rest2 * (gradient * gradient));
  n->m = Select(Abs(n->m) < smallest, F(0.f), n->m);
  n->v = Select(n->v < smallest, F(0.f), n->v);
  const F root = MulAdd(Sqrt(n->v), correction2_root, F(static_cast<float>(kAdamEpsilon)));
  n->value = n->value - rate * n->m / root;
}

/// d/d(logit) of weight * opacity, the opacity's regulariser.
template <class F>
ORACLEGS_HD inline F OpacityRegularizer(F opacity, F weight) {
  return weight * (opacity * (F(1.f) - opacity));
}

/// gradient + d/d(log scale) of weight * scale, the scales' regulariser.
template <class F>
ORACLEGS_HD inline F AddScaleRegularizer(F scale, F weight, F gradient) {
  return MulAdd(weight, scale, gradient);
}

}  // namespace
#if !defined(__CUDACC__)
HWY_AFTER_NAMESPACE();
#endif
#endif
