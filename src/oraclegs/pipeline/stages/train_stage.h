#pragma once

#include "oraclegs/pipeline/run.h"

namespace oraclegs {

/// Stage "train" (with "sfm" before it when it starts from the beginning): writes point_cloud.ply, continuing from the
/// newest checkpoint to the same bits. Not run again when photographs and options are unchanged; when the photographs
/// have changed it starts anew with a warning, and the old point_cloud.ply and metrics.json are removed. On an
/// interrupt a checkpoint is saved and Interrupted thrown.
void RunTrain(Run* run);

/// True when point_cloud.ply stands and was trained from these photographs and options.
bool IsTrained(const Run& run);

}  // namespace oraclegs
