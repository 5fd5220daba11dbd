#include "oraclegs/baselines/make_parts.h"

#include "oraclegs/baselines/adaptive_density.h"
#include "oraclegs/baselines/correlated_depth.h"
#include "oraclegs/baselines/depth_steps.h"
#include "oraclegs/baselines/prune_modes.h"
#include "oraclegs/baselines/pseudo_depths.h"
#include "oraclegs/baselines/random_background.h"
#include "oraclegs/baselines/two_fields.h"
#include "oraclegs/baselines/weight_photos.h"

namespace oraclegs {

void CheckBaseline(std::string_view method, const BaselineSettings& settings, const AutoTrainOptions& options) {
  if (!options.iterations.is_auto() && settings.prune_modes_at > options.iterations.value()) {
    throw UsageError("{} prunes at iteration {}, which lies beyond the last of {} --iterations; give more", method,
                     settings.prune_modes_at, options.iterations.value());
  }
  if (settings.adaptive && options.prune_floaters) {
    throw UsageError("--prune-floaters belongs to relocation, which {} does not have; leave it out", method);
  }
}

void AddBaseline(BaselineSetup* setup) {
  const BaselineSettings& settings = setup->baseline;
  if (settings.covisibility_weights) setup->data.photos = WeightByCovisibility(std::move(setup->data.photos));
  if (settings.adaptive) setup->densifier = AdaptiveDensifierMaker(settings, setup->background);
  if (settings.two_fields) setup->parts.push_back(std::make_shared<TwoFields>(*setup));
  if (settings.random_background) {
    setup->parts.push_back(std::make_shared<RandomBackgrounds>(setup->view_seed.value_or(setup->seed)));
  }
  if (settings.StepsByDepth()) setup->parts.push_back(std::make_shared<DepthSteps>(*setup));
  if (settings.depth_correlation > 0) setup->parts.push_back(std::make_shared<CorrelatedDepth>(*setup));
  if (settings.pseudo_depth_weight > 0) setup->parts.push_back(std::make_shared<PseudoDepths>(*setup));
  if (settings.prune_modes_at > 0) setup->parts.push_back(std::make_shared<PruneModes>(*setup));
}

}  // namespace oraclegs
