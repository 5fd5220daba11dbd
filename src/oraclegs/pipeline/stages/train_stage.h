#pragma once

#include "oraclegs/pipeline/stages/stage.h"

namespace oraclegs {

/// Stage "train": writes point_cloud.ply, continuing from the newest checkpoint to the same bits. When what it is
/// trained on has changed it starts anew with a warning, and the old point_cloud.ply and metrics.json are removed. On
/// an interrupt a checkpoint is saved and Interrupted thrown.
StageWork TrainStage();

}  // namespace oraclegs
