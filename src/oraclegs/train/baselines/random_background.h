#pragma once
// A random background color in each iteration [Zhang 2024]. It makes the shown scene opaque, since no color behind it
// is right for long.

#include <array>
#include <cstdint>

namespace oraclegs {

/// Uniform color in [0, 1)^3, a pure function of both arguments.
std::array<float, 3> RandomBackground(uint64_t seed, int64_t iteration);

}  // namespace oraclegs
