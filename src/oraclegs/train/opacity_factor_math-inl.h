// The factor of one Gaussian's opacity in one iteration; see opacity_factors.h. One body of code for all devices, like
// noise_math-inl.h.

#if defined(ORACLEGS_TRAIN_OPACITY_FACTOR_MATH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ORACLEGS_TRAIN_OPACITY_FACTOR_MATH_INL_H_
#undef ORACLEGS_TRAIN_OPACITY_FACTOR_MATH_INL_H_
#else
#define ORACLEGS_TRAIN_OPACITY_FACTOR_MATH_INL_H_
#endif

#include "oraclegs/core/device_macros.h"
#include "oraclegs/core/rng.h"
#include "oraclegs/core/simd/scalar_ops-inl.h"
#include "oraclegs/train/step_constants.h"

#if !defined(__CUDACC__)
#include <hwy/highway.h>
HWY_BEFORE_NAMESPACE();
namespace oraclegs::HWY_NAMESPACE {
#else
namespace oraclegs::cuda {
#endif

/// The factor from Philox::Draw(seed, kOpacityFactors, iteration << 32 | index), with a Box-Muller normal number.
template <class F, class U>
ORACLEGS_HD inline F OpacityFactor(const OpacityConstants& constants, U index) {
  U words[4] = {index, U(constants.iteration), U(static_cast<uint32_t>(RandomStream::kOpacityFactors)), U(uint32_t{0})};
  PhiloxRounds(constants.seed, words);
  const F kept = Select(OpenUniform(words[0]) < F(constants.drop), F(0.f), F(1.f / (1.f - constants.drop)));
  if (!(constants.noise > 0)) return kept;
  const F normal = Sqrt(F(-2.f) * Log(OpenUniform(words[1]))) * Cos(F(6.2831853f) * OpenUniform(words[2]));
  return kept * Max(F(1.f) + F(constants.noise) * normal, F(0.f));
}

}  // namespace
#if !defined(__CUDACC__)
HWY_AFTER_NAMESPACE();
#endif
#endif
