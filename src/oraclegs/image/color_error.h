#pragma once
// The error of a color, of which confidence and uncertainty speak.

#include <cmath>

namespace oraclegs {

/// Error of a color of three channels: the root of the mean square of their differences. Teaching, confidence and
/// every report of trust mean this by "error".
inline float ColorError(const float* a, const float* b) {
  float squares = 0;
  for (int c = 0; c < 3; ++c) squares += (a[c] - b[c]) * (a[c] - b[c]);
  return std::sqrt(squares / 3);
}

}  // namespace oraclegs
