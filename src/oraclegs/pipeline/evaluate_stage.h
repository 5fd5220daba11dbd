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
};

/// Reads a PLY of any trainer, to be rendered on the background and with the antialiasing of `options`.
Model LoadModel(const std::filesystem::path& ply, const RunOptions& options);

/// Stage "evaluate": scores point_cloud.ply on the test views and writes renders/test/*.png and metrics.json. Not run
/// again when point cloud and test photographs are unchanged. Throws InputError when there is no point cloud.
void RunEvaluate(Run* run);

/// What a point cloud of any trainer is scored on, without a workspace.
struct EvaluateRequest {
  std::filesystem::path ply;
  std::filesystem::path scene;
  RunOptions options;
  std::filesystem::path out;  ///< receives metrics.json and renders/test/*.png; empty = nothing is written
};

/// {"test": {...}, "gaussians": n, "ply", "options", ...}. Throws InputError when the scene has no poses.
nlohmann::json EvaluatePly(const EvaluateRequest& request, const Listener& listener);

}  // namespace oraclegs
