#pragma once
// What a patch is and how two are compared; for host and device.

namespace oraclegs {

/// Every second pixel of a 9 x 9 window, like one color of a checkerboard.
inline constexpr int kPatchRadius = 4;
inline constexpr int kPatchSamples = 41;
inline constexpr int kMaxChannels = 3;

/// The worst cost: 1 - ZNCC of opposite patches, and of patches that cannot be compared.
inline constexpr float kWorstCost = 2;

/// Of the bilateral weights; the value in 8-bit units, the mean over the channels.
inline constexpr double kSigmaPixels = 4, kSigmaValue = 20;

/// Variance that 8-bit rounding and sensor noise give a flat patch, per channel: without it their correlation is
/// chance.
inline constexpr float kNoiseVariance = 1.5f * 1.5f;

/// No sample of a patch may come nearer to the source camera than this share of its center's depth.
inline constexpr float kNearestShare = 0.1f;

}  // namespace oraclegs
