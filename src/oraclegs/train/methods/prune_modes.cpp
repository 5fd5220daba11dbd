#include "oraclegs/train/methods/prune_modes.h"

namespace oraclegs {

PruneModes::PruneModes(const TrainSetup& setup)
    : options_(setup.options.Settled()), background_(setup.background), cameras_(Cameras(setup.data.photos)) {
  const int at = options_.baseline.prune_modes_at, iterations = options_.iterations.value();
  if (at > iterations) {
    throw UsageError("--prune-modes-at {} lies beyond the last of {} --iterations; give an iteration of the run", at,
                     iterations);
  }
}

double PruneModes::BeforeView(const Iteration& iteration, TrainedModel* model, Gaussians*) {
  if (iteration.number != options_.baseline.prune_modes_at) return 0;
  const RenderOptions render{background_, iteration.sh_degree, options_.antialiased};
  const std::vector<uint8_t> floaters = FindModeFloaters(model->gaussians, cameras_, render, {});
  for (int64_t i = 0; i < model->gaussians.size(); ++i) {
    if (floaters[static_cast<size_t>(i)] == 0) continue;
    model->gaussians.opacity_logits[i] = kRemovedLogit;
    model->adam.m.opacity_logits[i] = model->adam.v.opacity_logits[i] = 0;
  }
  return 0;
}

}  // namespace oraclegs
