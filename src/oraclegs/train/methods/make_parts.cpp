#include "oraclegs/train/methods/make_parts.h"

#include "oraclegs/train/methods/depth_steps.h"
#include "oraclegs/train/methods/prune_modes.h"
#include "oraclegs/train/methods/pseudo_depths.h"
#include "oraclegs/train/methods/two_fields.h"

namespace oraclegs {

void CheckMethodOptions(const TrainOptions& options) {
  const BaselineOptions& baseline = options.baseline;
  if (!options.iterations.is_auto() && baseline.prune_modes_at > options.iterations.value()) {
    throw UsageError("--prune-modes-at {} lies beyond the last of {} --iterations; give an iteration of the run",
                     baseline.prune_modes_at, options.iterations.value());
  }
  if (baseline.densify == Densify::kAdaptive) {
    if (options.prune_floaters) throw UsageError("--prune-floaters goes with --densify mcmc; leave one of them out");
    return;
  }
  if (baseline.two_fields) throw UsageError("--two-fields goes with --densify adaptive; add it");
  if (baseline.split_lonely) throw UsageError("--split-lonely goes with --densify adaptive; add it");
  if (baseline.keep_large) throw UsageError("--keep-large goes with --densify adaptive; add it");
  if (baseline.unpool_until > 0) throw UsageError("--unpool-until goes with --densify adaptive; add it");
}

MethodParts MakeMethodParts(const TrainSetup& setup) {
  const BaselineOptions& options = setup.options.baseline;
  CheckMethodOptions(setup.options);
  MethodParts parts;
  if (options.two_fields) {
    parts.push_back(std::make_shared<TwoFields>(setup));
  }
  if (options.StepsByDepth()) parts.push_back(std::make_shared<DepthSteps>(setup));
  if (options.pseudo_depth_weight > 0) parts.push_back(std::make_shared<PseudoDepths>(setup));
  if (options.prune_modes_at > 0) parts.push_back(std::make_shared<PruneModes>(setup));
  return parts;
}

}  // namespace oraclegs
