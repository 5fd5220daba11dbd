#pragma once

#include <vector>

#include "oraclegs/pipeline/stages/depth_stage.h"
#include "oraclegs/train/options.h"

namespace oraclegs {

/// What is known of a scene before anything is proposed or trained.
struct Preparation {
  std::vector<ScenePoint> sfm;  ///< with indices of run->scene
  std::vector<LoadedView> photos;    ///< of the training views, in the order of the split
  Geometry geometry;            ///< empty where no later stage needs depth
  TrainOptions decided;         ///< the run's training options with nothing left to choose
};

/// Stages "sfm" and, when one that comes later needs it, "depth".
Preparation Prepare(Run* run);

}  // namespace oraclegs
