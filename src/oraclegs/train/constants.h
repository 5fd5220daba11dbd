#pragma once
// Constants of training that every device shares.

#include <cstdint>

namespace oraclegs {

// Adam of the Gaussians (docs/method.md#adam) and, but for epsilon, of the exposure maps.
inline constexpr double kAdamBeta1 = 0.9, kAdamBeta2 = 0.999;
inline constexpr double kAdamEpsilon = 1e-15;
/// Smaller moments become zero. Those of a Gaussian that no view sees any more decay into subnormal numbers and would
/// stay there, which is slow on many processors. Zero changes no parameter, since epsilon is far larger.
inline constexpr float kSmallestMoment = 1.17549435e-38f;
/// Odd constants that hash bits into rounding noise (RoundingNoise).
inline constexpr uint32_t kNoiseOfValue = 0x9e3779b1, kNoiseOfMoment = 0x85ebca77, kNoiseOfStep = 0xc2b2ae3d,
                          kNoiseMix = 0x2c1b3c6d, kNoiseShift = 15;
/// Weight of 1/2 |map - identity|^2, in units of the photometric loss. Where a photo constrains its map the loss is
/// steeper by orders of magnitude (a gain that is wrong by 0.2 costs about 0.05, to keep it costs 2e-4); unconstrained
/// parts, say the mixing of channels in a gray image, stay at the identity.
inline constexpr double kExposureRegularizer = 0.01;

inline constexpr double kExposureEpsilon = 1e-8;
/// Least determinant of a mean exposure map; a smaller one cannot be inverted back to the identity.
inline constexpr double kMinExposureDeterminant = 1e-6;

inline constexpr float kDeadOpacity = 0.005f;  ///< at or below: dead, to be relocated
inline constexpr int kMaxCopies = 51;          ///< n is clamped to this (docs/method.md#mcmc-relocation)
inline constexpr double kMaxOpacity = 1 - 0x1p-23, kMinOpacity = 0.005;  ///< range of a relocated opacity

inline constexpr double kNoiseRate = 5e5;
inline constexpr float kGateSlope = 100.f;
/// A smaller gate counts as zero (opacity above about 0.28). The displacement is gate * 5e5 * lr * Sigma * epsilon, and
/// 5e5 * lr is about 100 at most per unit of extent, so a dropped displacement is below 1e-9 of a Gaussian's own
/// squared size: below the rounding of a float.
inline constexpr float kMinNoiseGate = 1e-12f;

inline constexpr float kTrustedDepth = 0.5f;     ///< depth_mask above: the depth of this pixel is trusted
inline constexpr double kFloaterRatio = 1.1;     ///< 1/z more than this many times the depth's: before the surface
inline constexpr double kAgreementRatio = 0.05;  ///< |z * inv_depth - 1| below: on the surface
inline constexpr float kPrunedLogit = -6.9f;     ///< opacity 0.001: dead

}  // namespace oraclegs
