#pragma once

#include <nlohmann/json_fwd.hpp>

#include "oraclegs/run/start.h"

namespace oraclegs {

/// Runs all stages. Returns the content of metrics.json. The test images are read once before training, so that a
/// damaged one is reported before an hour is spent.
nlohmann::json Reconstruct(const RunRequest& request, const Listener& listener);

/// Runs the stages up to "evaluate" of a run that has been started: for experiments, whose runs need no report.
nlohmann::json Reconstruct(Run* run);

/// Scores point_cloud.ply as it is (only stage "evaluate"). Throws InputError when there is none.
void EvaluateRun(Run* run);

/// Points of a run's stage "sfm". Empty, after a warning, where they are not up to date; no stage runs.
std::vector<ScenePoint> SparsePointsOf(Run* run);

}  // namespace oraclegs
