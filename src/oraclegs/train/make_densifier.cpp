#include "oraclegs/train/make_densifier.h"

#include "oraclegs/train/floaters.h"
#include "oraclegs/train/mcmc.h"
#include "oraclegs/train/noise.h"
#include "oraclegs/train/train_device.h"

namespace oraclegs {
namespace {

class McmcDensifier final : public Densifier {
 public:
  explicit McmcDensifier(const DensifierSetup& setup) : options_(setup.options), plan_(setup.plan) {}

  bool AddsNoise() const override { return true; }

  void Refine(const Iteration& iteration, TrainedModel* model) override {
    Gaussians* gaussians = &model->gaussians;
    if (options_.prune_floaters) PruneFloaters(plan_.photos(), gaussians);
    RelocateDead(iteration.seed, iteration.number, gaussians, &model->adam);
    AddGaussians(iteration.seed, iteration.number, options_.max_gaussians, gaussians, &model->adam);
    AddNoise({iteration.seed, iteration.number, iteration.rates.means}, gaussians);
  }

 private:
  const TrainOptions& options_;
  const LossPlan& plan_;
};

}  // namespace

bool Densifier::Acts(const Iteration& iteration) const { return iteration.refines; }

std::unique_ptr<Densifier> MakeMcmcDensifier(const DensifierSetup& setup) {
  return std::make_unique<McmcDensifier>(setup);
}

}  // namespace oraclegs
