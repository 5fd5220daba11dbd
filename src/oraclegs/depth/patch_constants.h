#pragma once
// Constants of patches and of their comparison, for host and device.

namespace oraclegs {

/// Radius of the 9 x 9 window, of which a patch has every second pixel, like one color of a checkerboard.
inline constexpr int kPatchRadius = 4;
inline constexpr int kPatchSamples = 41;
inline constexpr int kMaxChannels = 3;

/// The worst cost: 1 - ZNCC of opposite patches; also that of patches that cannot be compared.
inline constexpr float kWorstCost = 2;

/// Standard deviations of the bilateral weights: distance in pixels, value in 8-bit units (mean over the channels).
inline constexpr double kSigmaPixels = 4, kSigmaValue = 20;

/// Variance per channel that 8-bit rounding and sensor noise give a flat patch; without it such patches correlate by
/// chance.
inline constexpr float kNoiseVariance = 1.5f * 1.5f;

/// Least depth of a patch's samples in the source camera, as a fraction of its center's.
inline constexpr float kNearestShare = 0.1f;

}  // namespace oraclegs
