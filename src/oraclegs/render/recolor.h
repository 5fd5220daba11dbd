#pragma once
// A model in other colors: its render shows a property of the Gaussians instead of their look, composited as always.

#include <array>
#include <span>

#include "oraclegs/gaussians/gaussians.h"

namespace oraclegs {

/// The Gaussians with one color each, equal from all sides. `colors`: [N,3] RGB on the host, any finite numbers; a
/// negative one is rendered as 0. Render the result with sh_degree 0. All buffers but `sh` are shared. Throws
/// ShapeError for another number of colors.
Gaussians Recolored(const Gaussians& gaussians, const Buffer<float>& colors);

/// How well a Gaussian is supported, best first.
enum class SupportClass { kSeenByTwo, kSeenByOne, kTrustedProposal, kWeak };
inline constexpr int kSupportClasses = 4;

/// Name of a class in texts: "seen by two or more images".
const char* NameOf(SupportClass support_class);
/// 8-bit sRGB color of a class, distinguishable without color vision [Wong 2011].
std::array<uint8_t, 3> ColorOf(SupportClass support_class);

/// Class of a Gaussian's support in [0, 1]: from 0.75 seen by two or more images, from 0.5 by one, from 0.25 proposed
/// and trusted, below weakly supported.
SupportClass SupportClassOf(float support);

/// [N,3] RGB in [0, 1]: the colors of the classes, for Recolored.
Buffer<float> SupportColors(std::span<const float> support);

}  // namespace oraclegs
