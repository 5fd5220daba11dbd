#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "oraclegs/scene/frame.h"
#include "oraclegs/settings/options.h"

namespace oraclegs {

/// A point cloud from any trainer, to be scored without a run.
struct EvaluateRequest {
  std::filesystem::path ply;
  RunOptions options;
  std::filesystem::path out;  ///< receives metrics.json and renders/test/*.png; empty = nothing is written
  std::string version;        ///< version of the program, for metrics.json
};

/// Scores: {"test": {...}, "gaussians": n, "ply", "non_commercial", "options", ...}. Throws InputError for a file that
/// holds no Gaussians, and when `out` holds a run or lies in the scene folder.
nlohmann::json EvaluatePly(const EvaluateRequest& request, const PosedScene& scene, const Listener& listener);

}  // namespace oraclegs
