#pragma once
// Noise on a lattice, of which the textures of the demo scene are made.

#include <cmath>
#include <cstdint>

#include "oraclegs/demo/vec3.h"

namespace oraclegs {

/// Cell of a coordinate, and the position within it.
struct LatticeCell {
  int64_t index;
  double at;  ///< [0, 1)
};

inline LatticeCell CellOf(double v) {
  const double low = std::floor(v);
  return {static_cast<int64_t>(low), v - low};
}

/// Uniform in [0, 1) at every lattice point, a pure function of integers.
double LatticeNoise(int64_t x, int64_t y, int64_t z, uint32_t seed);
/// Smooth noise in [0, 1) with one lump per unit.
double ValueNoise(const Vec3& p, uint32_t seed);
/// Sum of `octaves` of ValueNoise, each twice as fine and half as strong, in [0, 1).
double FractalNoise(const Vec3& p, int octaves, uint32_t seed);

}  // namespace oraclegs
