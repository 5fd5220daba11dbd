#pragma once

#include "oraclegs/stages/stage.h"

namespace oraclegs {

/// Stage "train": writes point_cloud.ply, continuing from the newest checkpoint to the same bits. The last
/// checkpoint stays: the same run with more --iterations goes on from it, over the new number's schedule. When what it
/// is trained on has changed it starts anew with a warning, and the old point_cloud.ply and metrics.json are removed.
/// On an interrupt a checkpoint is saved and Interrupted thrown.
StageWork TrainStage();

}  // namespace oraclegs
