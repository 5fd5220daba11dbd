#pragma once

#include "oraclegs/stages/stage.h"

namespace oraclegs {

/// Stage "register": poses for images without any, by colmap or by VGGT (--poses), into sfm/. The run's scene then has
/// poses, and the views that were registered.
StageWork RegisterStage();

/// Network of --poses. In a workspace whose poses stand already it has the weights that found them, also when those are
/// no longer on this machine. nullopt = colmap. Throws InputError as RequireVggtWeights where no poses stand.
std::optional<VggtWeights> PoseNetworkOf(const RunOptions& options, const Workspace& workspace);

}  // namespace oraclegs
