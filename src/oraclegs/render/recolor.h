#pragma once
// A model in other colors: a render of it shows a property of the Gaussians instead of how they look, composited in
// the same way.

#include <array>
#include <span>

#include "oraclegs/gaussians/gaussians.h"

namespace oraclegs {

/// The same Gaussians with one color each, the same from all sides. `colors`: [N,3] RGB on the host, any finite
/// numbers; a negative one is rendered as 0. To be rendered with sh_degree 0. All buffers but `sh` are shared. Throws
/// ShapeError for another number of colors.
Gaussians Recolored(const Gaussians& gaussians, const Buffer<float>& colors);

/// How well a Gaussian is supported, best first.
enum class SupportClass { kSeenByTwo, kSeenByOne, kTrustedProposal, kWeak };
inline constexpr int kSupportClasses = 4;

/// What a class is called in texts: "seen by two or more images".
const char* NameOf(SupportClass support_class);
/// 8-bit sRGB, distinguishable without color vision [Wong 2011].
std::array<uint8_t, 3> ColorOf(SupportClass support_class);

/// Of a Gaussian's support in [0, 1]: 0.75 and more is seen by two or more images, 0.5 by one, 0.25 proposed and
/// trusted, less is weakly supported.
SupportClass SupportClassOf(float support);

/// [N,3] RGB in [0, 1]: the colors of the classes, for Recolored.
Buffer<float> SupportColors(std::span<const float> support);

}  // namespace oraclegs
