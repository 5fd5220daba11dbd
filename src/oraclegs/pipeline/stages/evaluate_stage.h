#pragma once

#include <filesystem>

#include "oraclegs/evaluate/evaluate.h"
#include "oraclegs/gaussians/gaussians.h"
#include "oraclegs/pipeline/run.h"
#include "oraclegs/render/render.h"

namespace oraclegs {

/// A point cloud and how it is rendered.
struct Model {
  Gaussians gaussians;
  RenderOptions render;
  std::vector<std::string> non_commercial = {};  ///< networks that its file says it was made with
};

/// Reads a PLY of any trainer, to be rendered on the background, with the antialiasing and on the device of `options`.
Model LoadModel(const std::filesystem::path& ply, const RunOptions& options);

/// Stage "evaluate": scores point_cloud.ply on the test views and writes renders/test/*.png and metrics.json. Not run
/// again when point cloud and test photographs are unchanged. Throws InputError when there is no point cloud.
void RunEvaluate(Run* run);

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
