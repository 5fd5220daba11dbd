#pragma once

#include <nlohmann/json_fwd.hpp>

#include "oraclegs/run/start.h"

namespace oraclegs {

/// The whole run: all stages. Returns what metrics.json holds. The test images are read once before training, so that a
/// damaged one is reported before an hour is spent.
nlohmann::json Reconstruct(const RunRequest& request, const Listener& listener);

/// The same of a run that has been started, up to "evaluate": for experiments, whose runs nobody looks at.
nlohmann::json Reconstruct(Run* run);

/// Scores point_cloud.ply as it is (stage "evaluate" alone). Throws InputError when there is none.
void EvaluateRun(Run* run);

/// The points of a run's stage "sfm"; none, after a warning, where they are not up to date. Nothing is made anew.
std::vector<ScenePoint> SparsePointsOf(Run* run);

}  // namespace oraclegs
