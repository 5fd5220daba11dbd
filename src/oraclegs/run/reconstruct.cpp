#include "oraclegs/run/reconstruct.h"

#include <nlohmann/json.hpp>

#include "oraclegs/run/best_so_far.h"
#include "oraclegs/run/stages.h"
#include "oraclegs/stages/metrics.h"
#include "oraclegs/stages/run_observer.h"
#include "oraclegs/workspace/stage_records.h"

namespace oraclegs {

namespace {

void BringUpToDate(const std::vector<const char*>& stages, Run* run) {
  Guarded(run->observer.get(), [&] {
    if (!IsUpToDate(run, "train")) {
      for (const int view : run->split.test) LoadViews(run->scene, {view}, run->plan.image, Silent());
      if (run->observer) run->observer->Show(run, "register");
    }
    try {
      for (const char* stage : stages) RunStage(run, stage);
    } catch (const Interrupted&) {
      LeaveBestSoFar(run);
      throw;
    }
  });
}

}  // namespace

nlohmann::json Reconstruct(Run* run) {
  BringUpToDate({"evaluate"}, run);
  return ReadMetrics(run->workspace.root());
}

nlohmann::json Reconstruct(const RunRequest& request, const Listener& listener) {
  RunRequest estimated = request;
  estimated.estimates = true;
  Run run = StartRun(estimated, listener);
  BringUpToDate({"evaluate", "report"}, &run);
  return ReadMetrics(run.workspace.root());
}

void EvaluateRun(Run* run) {
  std::error_code ignored;
  if (!std::filesystem::exists(run->workspace.point_cloud(), ignored)) {
    throw InputError("{}: does not exist; run `oraclegs train` first, or name a point cloud with --ply",
                     run->workspace.point_cloud().string());
  }
  if (const std::string of = UnfinishedSplat(run->workspace.root()); !of.empty()) {
    throw InputError("{}: its run was stopped: this is its {}, which has no scores; the command that began it goes on",
                     run->workspace.point_cloud().string(), of);
  }
  RunStageAlone(run, Stages(), "evaluate");
}

std::vector<ScenePoint> SparsePointsOf(Run* run) {
  if (!IsUpToDate(run, "sfm")) {
    run->listener(
        Warning{fmt::format("{}: its sparse points are not there any more, or were never made; the cameras "
                            "are written without points",
                            run->workspace.root().string())});
    return {};
  }
  RunStage(run, "sfm");  // reads them
  return run->results->points;
}

}  // namespace oraclegs
