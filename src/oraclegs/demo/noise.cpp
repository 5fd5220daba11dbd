#include "oraclegs/demo/noise.h"

namespace oraclegs {

double LatticeNoise(int64_t x, int64_t y, int64_t z, uint32_t seed) {
  uint32_t h = seed * 0x9E3779B1u + 0x7F4A7C15u;
  for (const int64_t v : {x, y, z}) {
    h ^= static_cast<uint32_t>(v) * 0x85EBCA6Bu;
    h = (h ^ (h >> 15)) * 0x2C1B3C6Du;
    h ^= h >> 13;
  }
  h = (h ^ (h >> 12)) * 0x297A2D39u;
  return (h >> 8) * 0x1.0p-24;
}

double ValueNoise(const Vec3& p, uint32_t seed) {
  const LatticeCell x = CellOf(p.x), y = CellOf(p.y), z = CellOf(p.z);
  const auto fade = [](double t) { return t * t * (3 - 2 * t); };
  const double fx = fade(x.at), fy = fade(y.at), fz = fade(z.at);
  const auto layer = [&](int64_t k) {
    const auto row = [&](int64_t j) {
      return Mix(LatticeNoise(x.index, y.index + j, z.index + k, seed),
                 LatticeNoise(x.index + 1, y.index + j, z.index + k, seed), fx);
    };
    return Mix(row(0), row(1), fy);
  };
  return fz == 0 ? layer(0) : Mix(layer(0), layer(1), fz);
}

double FractalNoise(const Vec3& p, int octaves, uint32_t seed) {
  double sum = 0, weight = 0, strength = 1, scale = 1;
  for (int i = 0; i < octaves; ++i) {
    // Whole-number scales keep a coordinate that is 0 on the lattice, where half of the work falls away.
    sum += strength * ValueNoise(p * scale, seed + 17 * static_cast<uint32_t>(i));
    weight += strength;
    strength *= .6;
    scale *= 2;
  }
  return sum / weight;
}

}  // namespace oraclegs
