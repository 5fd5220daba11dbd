#include "oraclegs/baselines/prune_modes.h"

#include "oraclegs/train/train_device.h"

namespace oraclegs {

PruneModes::PruneModes(const BaselineSetup& setup)
    : at_(setup.baseline.prune_modes_at),
      antialiased_(setup.options.antialiased),
      background_(setup.background),
      cameras_(Cameras(setup.data.photos)) {}

double PruneModes::BeforeView(const Iteration& iteration, TrainedModel* model, PartGradients*) {
  if (iteration.number != at_) return 0;
  const RenderOptions render{background_, iteration.sh_degree, antialiased_};
  OnHost(model, [&](TrainedModel* host) {
    const std::vector<uint8_t> floaters = FindModeFloaters(host->gaussians, cameras_, render, {});
    for (int64_t i = 0; i < host->gaussians.size(); ++i) {
      if (floaters[static_cast<size_t>(i)] == 0) continue;
      host->gaussians.opacity_logits[i] = kRemovedLogit;
      host->adam.m.opacity_logits[i] = host->adam.v.opacity_logits[i] = 0;
    }
  });
  return 0;
}

}  // namespace oraclegs
