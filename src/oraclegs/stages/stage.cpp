#include "oraclegs/stages/stage.h"

namespace oraclegs {

const TrainingViews& ViewsOf(Run* run) {
  std::unique_ptr<TrainingViews>& views = run->results->views;
  if (!views) {
    views = std::make_unique<TrainingViews>(LoadViews(run->scene, run->split.train, run->options.image, run->listener));
  }
  return *views;
}

}  // namespace oraclegs
