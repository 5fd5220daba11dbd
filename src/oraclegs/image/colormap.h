#pragma once
// Colors for numbers in [0, 1], of equal steps to the eye and readable without color vision.

#include <array>
#include <cstdint>

namespace oraclegs {

enum class ColorMap {
  kPlasma,   ///< confidence: dark blue 0, purple, orange, yellow 1; the map of [Topaloglu 2026]
  kViridis,  ///< depth: dark purple 0, blue, green, yellow 1
};

/// 8-bit sRGB. Values outside of [0, 1] have the color of the nearer end, as has NaN of 0.
std::array<uint8_t, 3> MapColor(ColorMap map, float value);

}  // namespace oraclegs
