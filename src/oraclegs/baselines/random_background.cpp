#include "oraclegs/baselines/random_background.h"

#include "oraclegs/core/rng.h"
#include "oraclegs/train/train_view.h"

namespace oraclegs {

std::array<float, 3> RandomBackground(uint64_t seed, int64_t iteration) {
  Rng rng(seed, RandomStream::kBackground, 3 * static_cast<uint64_t>(iteration));
  std::array<float, 3> color{};
  for (float& channel : color) channel = static_cast<float>(rng.Uniform());
  return color;
}

std::optional<std::array<float, 3>> RandomBackgrounds::Background(const Iteration& iteration,
                                                                  const TrainView& photo) const {
  if (photo.alpha.defined()) return std::nullopt;
  return RandomBackground(seed_, iteration.number);
}

}  // namespace oraclegs
