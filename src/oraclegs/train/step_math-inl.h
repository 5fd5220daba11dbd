// The mathematics of one training step: Adam and the regularizers (docs/method.md#adam, #regularizers). One body of
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

/// A parameter with its two moments.
template <class F>
struct AdamNumber {
  F value, m, v;
};

template <class F>
ORACLEGS_HD inline F NextFirstMoment(F gradient, F m) {
  const F beta1(static_cast<float>(kAdamBeta1)), rest1(static_cast<float>(1 - kAdamBeta1));
  const F next = MulAdd(beta1, m, rest1 * gradient);
  return Select(Abs(next) < F(kSmallestMoment), F(0.f), next);
}

/// The next second moment. square: squared gradient.
template <class F>
ORACLEGS_HD inline F NextSecondMoment(F square, F v) {
  const F beta2(static_cast<float>(kAdamBeta2)), rest2(static_cast<float>(1 - kAdamBeta2));
  const F next = MulAdd(beta2, v, rest2 * square);
  return Select(next < F(kSmallestMoment), F(0.f), next);
}

/// Denominator of a step, sqrt(v_hat) + epsilon. correction2_root: 1 / sqrt(1 - beta2^t).
template <class F>
ORACLEGS_HD inline F RootOf(F v, F correction2_root) {
  return MulAdd(Sqrt(v), correction2_root, F(static_cast<float>(kAdamEpsilon)));
}

/// Takes a step of Adam. rate: learning rate / (1 - beta1^t).
template <class F>
ORACLEGS_HD inline void StepNumber(F gradient, F rate, F correction2_root, AdamNumber<F>* n) {
  n->m = NextFirstMoment(gradient, n->m);
  n->v = NextSecondMoment(gradient * gradient, n->v);
  n->value = n->value - rate * n->m / RootOf(n->v, correction2_root);
}

/// Random bits for rounding a second moment (ToBfloat16AtRandom), hashed from its bits, those of its parameter and the
/// number of the step: reproducible, and uncorrelated from step to step also where only the step changes. U: uint32_t,
/// or lanes of it.
template <class U>
struct RoundingNoise {
  U of_value, of_moment, mix, shift, step;

  ORACLEGS_HD inline U operator()(U value, U moment) const {
    const U sum = value * of_value + moment * of_moment + step;
    return (sum ^ (sum >> shift)) * mix;
  }
};

/// Mean squared gradient over all active coefficients of one Gaussian, from that of the constant coefficient. Gradients
/// of coefficients are the color's gradient times the harmonics, and the squares of all harmonics up to a degree have
/// the constant one's mean in every direction.
template <class F>
ORACLEGS_HD inline F MeanShSquare(F red, F green, F blue) {
  return (red * red + green * green + blue * blue) * F(1 / 3.f);
}

/// d/d(logit) of weight * opacity, the opacity's regularizer.
template <class F>
ORACLEGS_HD inline F OpacityRegularizer(F opacity, F weight) {
  return weight * (opacity * (F(1.f) - opacity));
}

/// gradient + d/d(log scale) of weight * scale, the scales' regularizer.
template <class F>
ORACLEGS_HD inline F AddScaleRegularizer(F scale, F weight, F gradient) {
  return MulAdd(weight, scale, gradient);
}

}  // namespace
#if !defined(__CUDACC__)
HWY_AFTER_NAMESPACE();
#endif
#endif
