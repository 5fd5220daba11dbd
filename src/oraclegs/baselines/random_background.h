#pragma once
// A random background color in each iteration [Zhang 2024]. It makes the shown scene opaque, since no color behind it
// is right for long.

#include <array>
#include <cstdint>

#include "oraclegs/train/method_part.h"

namespace oraclegs {

/// Uniform color in [0, 1)^3, a pure function of both arguments.
std::array<float, 3> RandomBackground(uint64_t seed, int64_t iteration);

/// Part that renders photos without transparency before such a color.
class RandomBackgrounds final : public MethodPart {
 public:
  explicit RandomBackgrounds(uint64_t seed) : seed_(seed) {}

  std::optional<std::array<float, 3>> Background(const Iteration& iteration, const TrainView& photo) const override;

 private:
  uint64_t seed_;
};

}  // namespace oraclegs
