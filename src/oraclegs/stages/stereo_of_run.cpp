#include "oraclegs/stages/stereo_of_run.h"

#include "oraclegs/scene/loaded_view.h"

#include "oraclegs/scene/frame.h"

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
  return EstimateDepth(views, SeenByTrainingViews(run), run.options.stereo.Settled(),
                       MakePlaneSearch(run.plan.device).get(), listener);
}

std::vector<double> ConfirmedDepth(Scene model, Device device) {
  const std::vector<int> all = AllViews(model);
  ApplyFrame(NormalFrame(model, all), &model);
  constexpr int kSmallSide = 250;  // pixels
  ImageOptions small;
  small.max_size = kSmallSide;
  const std::vector<LoadedView> views = LoadViews(model, all, small, Silent());
  std::vector<double> shares;
  for (const DepthMap& map :
       EstimateDepth(views, model.points, StereoOptions(), MakePlaneSearch(device).get(), Silent())) {
    shares.push_back(ConfidentShare(map));
  }
  return shares;
}

}  // namespace oraclegs
