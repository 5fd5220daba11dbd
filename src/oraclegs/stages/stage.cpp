#include "oraclegs/stages/stage.h"
#include "oraclegs/core/error.h"

namespace oraclegs {

const TrainingViews& ViewsOf(Run* run) {
  std::unique_ptr<TrainingViews>& views = run->results->views;
  if (!views) {
    views = std::make_unique<TrainingViews>(LoadViews(run->scene, run->split.train, run->plan.image, run->listener));
  }
  return *views;
}

const Stage& StageNamed(const std::vector<Stage>& stages, const std::string& name) {
  for (const Stage& stage : stages) {
    if (stage.name == name) return stage;
  }
  throw RunError("there is no stage {}", name);
}

}  // namespace oraclegs
