#include "oraclegs/train/methods/make_parts.h"

#include "oraclegs/train/methods/depth_steps.h"
#include "oraclegs/train/methods/prune_modes.h"
#include "oraclegs/train/methods/two_fields.h"

namespace oraclegs {

MethodParts MakeMethodParts(const TrainSetup& setup) {
  const BaselineOptions& options = setup.options.baseline;
  MethodParts parts;
  if (options.two_fields) {
    if (options.densify != Densify::kAdaptive) throw UsageError("--two-fields goes with --densify adaptive; add it");
    parts.push_back(std::make_shared<TwoFields>(setup));
  }
  if (options.StepsByDepth()) parts.push_back(std::make_shared<DepthSteps>(setup));
  if (options.prune_modes_at > 0) parts.push_back(std::make_shared<PruneModes>(setup));
  return parts;
}

}  // namespace oraclegs
