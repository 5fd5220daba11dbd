#pragma once

#include <nlohmann/json.hpp>

#include "oraclegs/pipeline/run.h"

namespace oraclegs {

/// The whole run: start, sfm, train, evaluate. Returns what metrics.json holds. The test photographs are read once
/// before training, so that a damaged one is told before an hour is spent.
nlohmann::json Reconstruct(const RunRequest& request, const Listener& listener);

/// The same of a run that has been started.
nlohmann::json Reconstruct(Run* run);

}  // namespace oraclegs
