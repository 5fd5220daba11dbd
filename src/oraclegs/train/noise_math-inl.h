// The noise of 3DGS-MCMC on one Gaussian's center (docs/method.md#mcmc-noise). One body of code for all devices; F is a
// number type as in render/splat_math-inl.h, with MulAdd, Log, Cos and Sin; U is the whole numbers that go with it.

#if defined(ORACLEGS_TRAIN_NOISE_MATH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ORACLEGS_TRAIN_NOISE_MATH_INL_H_
#undef ORACLEGS_TRAIN_NOISE_MATH_INL_H_
#else
#define ORACLEGS_TRAIN_NOISE_MATH_INL_H_
#endif

#include "oraclegs/core/device_macros.h"
#include "oraclegs/core/rng.h"
#include "oraclegs/core/simd/scalar_ops-inl.h"
#include "oraclegs/render/splat_math-inl.h"
#include "oraclegs/train/constants.h"
#include "oraclegs/train/step_constants.h"

#if !defined(__CUDACC__)
#include <hwy/highway.h>
HWY_BEFORE_NAMESPACE();
namespace oraclegs::HWY_NAMESPACE {
#else
namespace oraclegs::cuda {
#endif

/// Factor of a Gaussian's noise: 1 for the transparent, 0 for the opaque.
template <class F>
ORACLEGS_HD inline F NoiseGate(F logit) {
  return Sigmoid(F(-kGateSlope) * (Sigmoid(logit) - F(kDeadOpacity)));
}

/// A gate below kMinNoiseGate counts as zero: these Gaussians stay where they are.
template <class F>
ORACLEGS_HD inline auto IsMoved(F gate) {
  return gate >= F(kMinNoiseGate);
}

/// Three standard normal numbers of Philox::Draw(seed, kNoise, iteration << 32 | index) by Box and Muller: two from the
/// first pair of words, one from the second.
template <class F, class U>
ORACLEGS_HD inline void DrawNormals(const NoiseConstants& noise, U index, F* e) {
  U words[4] = {index, U(noise.iteration), U(static_cast<uint32_t>(RandomStream::kNoise)), U(uint32_t{0})};
  PhiloxRounds(noise.seed, words);
  const F turn(6.2831853f);
  const F radius0 = Sqrt(F(-2.f) * Log(OpenUniform(words[0])));
  const F radius1 = Sqrt(F(-2.f) * Log(OpenUniform(words[2])));
  const F angle0 = turn * OpenUniform(words[1]), angle1 = turn * OpenUniform(words[3]);
  e[0] = radius0 * Cos(angle0);
  e[1] = radius0 * Sin(angle0);
  e[2] = radius1 * Cos(angle1);
}

/// e = Sigma e, Sigma = R S^2 R' of the raw quaternion and log scales.
template <class F>
ORACLEGS_HD inline void TimesCovariance(const F* q, const F* log_scale, F* e) {
  const F norm2 = MulAdd(q[0], q[0], MulAdd(q[1], q[1], MulAdd(q[2], q[2], q[3] * q[3])));
  const F k = F(2.f) / norm2;  // 2 / |q|^2 normalizes every product of two components
  const F kx = k * q[1], ky = k * q[2], kz = k * q[3];
  const F xx = kx * q[1], yy = ky * q[2], zz = kz * q[3];
  const F xy = kx * q[2], xz = kx * q[3], yz = ky * q[3];
  const F wx = kx * q[0], wy = ky * q[0], wz = kz * q[0];
  const F one(1.f);
  const F r[3][3] = {
      {one - (yy + zz), xy - wz, xz + wy}, {xy + wz, one - (xx + zz), yz - wx}, {xz - wy, yz + wx, one - (xx + yy)}};
  F a[3];
  for (int j = 0; j < 3; ++j) {
    const F s = BoundedExp(log_scale[j]);
    a[j] = MulAdd(r[0][j], e[0], MulAdd(r[1][j], e[1], r[2][j] * e[2]));
    a[j] = s * s * a[j];
  }
  for (int i = 0; i < 3; ++i) e[i] = MulAdd(r[i][0], a[0], MulAdd(r[i][1], a[1], r[i][2] * a[2]));
}

/// Turns normal numbers into the displacement Sigma (e gate strength); zero where the gate is closed, whose products
/// would be slow subnormal numbers.
template <class F>
ORACLEGS_HD inline void Displace(F gate, F strength, const F* q, const F* log_scale, F* e) {
  const F scaled = Select(IsMoved(gate), gate * strength, F(0.f));
  for (int k = 0; k < 3; ++k) e[k] = e[k] * scaled;
  TimesCovariance(q, log_scale, e);
}

}  // namespace
#if !defined(__CUDACC__)
HWY_AFTER_NAMESPACE();
#endif
#endif
