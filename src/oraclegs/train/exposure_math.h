#pragma once
// The mathematics of an exposure map (exposure.h) for host and device: a pixel seen through it and the adjoint, the
// regularizer, and the gauge. A map is 12 numbers, the 3x4 matrix [A b] row by row.

#include "oraclegs/core/device_macros.h"

namespace oraclegs {

/// shown = A rgb + b. `shown` may be `rgb`.
ORACLEGS_HD inline void ShowPixel(const float* map, const float* rgb, float* shown) {
  const float r = rgb[0], g = rgb[1], b = rgb[2];
  for (int k = 0; k < 3; ++k) shown[k] = map[4 * k] * r + map[4 * k + 1] * g + map[4 * k + 2] * b + map[4 * k + 3];
}

/// The adjoint: adds dL/d(map), grad (rgb, 1)', to `sums` and multiplies grad by A'.
ORACLEGS_HD inline void ShowPixelBackward(const float* map, const float* rgb, float* grad, double* sums) {
  const float g[3] = {grad[0], grad[1], grad[2]};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) sums[4 * row + column] += static_cast<double>(g[row] * rgb[column]);
    sums[4 * row + 3] += static_cast<double>(g[row]);
    grad[row] = map[row] * g[0] + map[4 + row] * g[1] + map[8 + row] * g[2];
  }
}

/// weight / 2 * |map - identity|^2, whose gradient is added.
ORACLEGS_HD inline double RegularizeExposure(const float* map, double weight, double* gradient) {
  double squares = 0;
  for (int k = 0; k < 12; ++k) {
    const double offset = static_cast<double>(map[k]) - (k % 5 == 0 ? 1 : 0);  // the identity has ones at 0, 5, 10
    squares += offset * offset;
    gradient[k] += weight * offset;
  }
  return 0.5 * weight * squares;
}

/// Inverts the 3x3 part of the mean map by cofactors; `inverse` is row-major. Returns the determinant, at whose 0 the
/// inverse is not finite.
ORACLEGS_HD inline double InvertExposure(const double* mean, double* inverse) {
  for (int row = 0; row < 3; ++row) {
    const int below = (row + 1) % 3, above = (row + 2) % 3;
    for (int column = 0; column < 3; ++column) {
      const int next = (column + 1) % 3, last = (column + 2) % 3;
      inverse[3 * column + row] =
          mean[4 * below + next] * mean[4 * above + last] - mean[4 * below + last] * mean[4 * above + next];
    }
  }
  const double determinant = mean[0] * inverse[0] + mean[4] * inverse[1] + mean[8] * inverse[2];
  const double factor = 1 / determinant;
  for (int k = 0; k < 9; ++k) inverse[k] *= factor;
  return determinant;
}

/// Maps (A, b) to (A M^-1, b - A M^-1 c) for the mean map (M, c).
ORACLEGS_HD inline void MoveExposureGauge(const double* inverse, const double* mean, float* map) {
  double fixed[12];
  for (int row = 0; row < 3; ++row) {
    double shift = 0;
    for (int column = 0; column < 3; ++column) {
      double sum = 0;
      for (int k = 0; k < 3; ++k) sum += static_cast<double>(map[4 * row + k]) * inverse[3 * k + column];
      fixed[4 * row + column] = sum;
      shift += sum * mean[4 * column + 3];
    }
    fixed[4 * row + 3] = static_cast<double>(map[4 * row + 3]) - shift;
  }
  for (int k = 0; k < 12; ++k) map[k] = static_cast<float>(fixed[k]);
}

}  // namespace oraclegs
