#include "oraclegs/pipeline/reconstruct.h"

#include "oraclegs/pipeline/stages/evaluate_stage.h"
#include "oraclegs/pipeline/workspace/metrics.h"
#include "oraclegs/pipeline/stages/train_stage.h"

namespace oraclegs {

nlohmann::json Reconstruct(Run* run) {
  if (!IsTrained(*run)) {
    for (const int view : run->split.test) LoadViews(run->scene, {view}, run->options.photo, Silent());
    RunTrain(run);
  }
  RunEvaluate(run);
  return ReadMetrics(run->workspace.root());
}

nlohmann::json Reconstruct(const RunRequest& request, const Listener& listener) {
  Run run = StartRun(request, listener);
  return Reconstruct(&run);
}

}  // namespace oraclegs
