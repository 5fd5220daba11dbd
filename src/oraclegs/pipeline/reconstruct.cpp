#include "oraclegs/pipeline/reconstruct.h"

#include <nlohmann/json.hpp>

#include "oraclegs/pipeline/stages/metrics.h"
#include "oraclegs/pipeline/stages/stages.h"

namespace oraclegs {

nlohmann::json Reconstruct(Run* run) {
  if (!IsUpToDate(run, "train")) {
    for (const int view : run->split.test) LoadViews(run->scene, {view}, run->options.image, Silent());
  }
  RunStage(run, "evaluate");
  return ReadMetrics(run->workspace.root());
}

nlohmann::json Reconstruct(const RunRequest& request, const Listener& listener) {
  Run run = StartRun(request, listener);
  return Reconstruct(&run);
}

void EvaluateRun(Run* run) {
  std::error_code ignored;
  if (!std::filesystem::exists(run->workspace.point_cloud(), ignored)) {
    throw InputError("{}: does not exist; run `oraclegs train` first, or name a point cloud with --ply",
                     run->workspace.point_cloud().string());
  }
  RunStageAlone(run, Stages(), "evaluate");
}

}  // namespace oraclegs
