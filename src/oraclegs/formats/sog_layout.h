#pragma once
// How the numbers of a SOG file stand in its images.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace oraclegs {

inline constexpr int kSogVersion = 2;
inline constexpr const char *kSogModel = "model", *kSogAntialiased = "antialiased";  ///< a key, and a value of it
inline constexpr int kSogPaletteColumns = 64;         ///< sets of harmonics side by side in their image
inline constexpr int kSogMostColors = 65536;          ///< sets of harmonics that a label can name
inline constexpr uint8_t kSogFirstRotationTag = 252;  ///< alpha of a quaternion's pixel, plus its largest component
inline constexpr float kSogSqrtHalf = 0.70710678f;

/// Positions are stored in a scale that is fine near the origin.
/// Doubles: far from the origin, the logarithms of neighbors differ by less than a float can tell.
inline double ToLogSpace(float x) { return std::copysign(std::log1p(std::abs(double{x})), double{x}); }
inline float FromLogSpace(double y) {
  constexpr double kLargest = std::numeric_limits<float>::max();
  const double x = std::expm1(std::abs(y));
  return static_cast<float>(std::copysign(x > kLargest && x < kLargest * 1.001 ? kLargest : x, y));
}

/// Support as a byte: 256 steps from their lower ends, so that the borders of its classes are kept.
inline uint8_t PackSupport(float support) { return static_cast<uint8_t>(std::min(support * 256, 255.f)); }
inline float UnpackSupport(uint8_t byte) { return byte == 255 ? 1.f : static_cast<float>(byte) / 256; }

}  // namespace oraclegs
