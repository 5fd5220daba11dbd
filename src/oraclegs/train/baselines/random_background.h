#pragma once
// A background of another color in each iteration [Zhang 2024]: what a photo shows must be opaque, since nothing behind
// it has the right color for long.

#include <array>
#include <cstdint>

namespace oraclegs {

/// Uniform in [0, 1)^3, a function of both.
std::array<float, 3> RandomBackground(uint64_t seed, int64_t iteration);

}  // namespace oraclegs
