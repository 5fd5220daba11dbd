#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "oraclegs/evaluate/evaluate.h"
#include "oraclegs/gaussians/gaussians.h"
#include "oraclegs/gaussians/selection.h"
#include "oraclegs/render/render.h"
#include "oraclegs/stages/run_observer.h"
#include "oraclegs/stages/stage.h"

namespace oraclegs {

/// A point cloud and how it is rendered.
struct Model {
  Gaussians gaussians;
  RenderOptions render;
  std::vector<std::string> non_commercial = {};  ///< networks that its file says it was made with
  GaussianMarks marks = {};                      ///< what the file says of each
  std::optional<double> unit_meters = {};        ///< length of a unit of the file, or of the scene; nothing = not known
  /// For its Uncertainty, in the same coordinates and on the same device; nothing = a file alone, of which only its
  /// marks are known.
  std::optional<std::vector<Gaussians>> others = {};
};

/// Reads a PLY of any trainer into the run's coordinates, to be rendered on the background, antialiased where `options`
/// or the file say so, and on `device`. The file is in the coordinates that models of `frame` are written in, but for
/// the offset that its header names; one whose unit is known and another, as of an export in meters, is scaled.
/// Everything that the reader left out or assumed is a Warning.
Model LoadModel(const std::filesystem::path& ply, const RunOptions& options, Device device,
                const SceneFrame& frame = {}, const Listener& listener = Silent());

/// Reads the models that a run's result was compared with, as record "train" names them, in the run's coordinates.
/// Nothing where it does not, or, with a warning, where a file is missing or damaged.
std::optional<std::vector<Gaussians>> ModelsBeside(const WorkspacePaths& paths, const nlohmann::json& train_record,
                                                   Device device, const Listener& listener);

/// Scores a model on the views {"psnr", ...} (evaluate.h); warns when there are none. `renders`: receives the images,
/// empty = nothing is written. `lpips`: files of its weights, none = no such score.
nlohmann::json ScoreModel(const Model& model, const std::vector<LoadedView>& views,
                          const std::filesystem::path& renders, const std::vector<std::filesystem::path>& lpips,
                          const Listener& listener);

/// Stage "evaluate": scores point_cloud.ply on the test views and writes renders/test/*.png and metrics.json. Also run
/// again when the point cloud is another file.
StageWork EvaluateStage();

/// How --eval-every scores the run's test views while it trains; never, without it or without test views. Loads them.
TestScore TestScoreOf(const Run& run);

}  // namespace oraclegs
