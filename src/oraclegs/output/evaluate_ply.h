#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "oraclegs/scene/posed_scene.h"
#include "oraclegs/settings/options.h"

namespace oraclegs {

/// A point cloud of any trainer, to be scored without touching a run.
struct EvaluateRequest {
  std::filesystem::path ply;
  RunOptions options;
  std::filesystem::path out;  ///< receives metrics.json and renders/test/*.png; empty = nothing is written
  std::string version;        ///< of the program, for metrics.json
};

/// {"test": {...}, "gaussians": n, "ply", "non_commercial", "options", ...}. Throws InputError for a file that is no
/// such point cloud, or when `out` holds a run or lies in the scene folder.
nlohmann::json EvaluatePly(const EvaluateRequest& request, const PosedScene& scene, const Listener& listener);

}  // namespace oraclegs
