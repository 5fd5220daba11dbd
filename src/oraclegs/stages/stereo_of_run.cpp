#include "oraclegs/stages/stereo_of_run.h"

#include <algorithm>
#include <memory>
#include <utility>
#include <variant>

#include "oraclegs/depth/plane_search.h"
#include "oraclegs/depth/stereo.h"

namespace oraclegs {

std::vector<ScenePoint> SeenByTrainingViews(const Run& run) {
  std::vector<ScenePoint> points = run.results->points;
  for (ScenePoint& point : points) {
    std::vector<int> views;
    for (const int view : point.views) {
      const auto found = std::find(run.split.train.begin(), run.split.train.end(), view);
      if (found != run.split.train.end()) views.push_back(static_cast<int>(found - run.split.train.begin()));
    }
    point.views = std::move(views);
  }
  return points;
}

std::vector<DepthMap> StereoOf(const Run& run, const std::vector<LoadedView>& views, const char* stage) {
  const Listener listener = [&](const Event& event) {
    const StepDone* step = std::get_if<StepDone>(&event);
    if (step == nullptr) return run.listener(event);
    StepDone named = *step;
    named.stage = stage;
    run.listener(named);
  };
  return EstimateDepth(views, SeenByTrainingViews(run), run.options.stereo, MakePlaneSearch(run.plan.device).get(),
                       listener);
}

}  // namespace oraclegs
