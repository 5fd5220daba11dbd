#pragma once
// Starts a run, or opens one that was started.

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "oraclegs/scene/posed_scene.h"
#include "oraclegs/stages/stage.h"

namespace oraclegs {

struct RunRequest {
  std::filesystem::path scene;  ///< the user's folder, only ever read
  /// Instead of `scene`, whatever the user named: one folder, which is the scene, or photos, videos, zip archives and
  /// folders, which are imported to OUT/photos.
  std::vector<std::filesystem::path> inputs;
  std::filesystem::path out;  ///< the workspace
  RunOptions options;
  bool estimates = false;                 ///< say how long each stage up to the report will take
  bool overwrite = false;                 ///< remove what an earlier run left in the workspace
  std::string version;                    ///< of the program, for metrics.json
  std::function<void()> on_claimed = {};  ///< called when the workspace is held, before the first stage; may be empty
};

/// Reads a scene that has poses of its own, into the frame that a run on it has. Throws InputError for a plain folder
/// of photos.
PosedScene ReadPosedScene(const std::filesystem::path& root, const RunOptions& options, const Listener& listener);

/// The folder of a request that names just one. Throws UsageError otherwise: the command takes no more.
std::filesystem::path OneFolder(const RunRequest& request);

/// Reads the scene (or imports it: stage "import", and warns of photos that look unfit), settles the plan and the size
/// of the run, claims the workspace (workspace.h says when that is refused), finds poses for a plain folder of photos
/// (stage "register"), brings the scene into its frame, splits, reports the split, and writes options.json and
/// split.json. Bad input is found before anything is written, except what needs the import or the poses. Weights that
/// --allow-fallback does without are not in the run's options. From then on until the run's end it writes live/ and
/// train.csv. Throws UsageError, InputError or RunError.
Run StartRun(const RunRequest& request, const Listener& listener);

/// The run that stands in request.out, with the scene it was started on, to look at its results or to score them;
/// request.scene is not read. Throws InputError when request.options differ in what shapes the result.
Run OpenRun(const RunRequest& request, const Listener& listener);

}  // namespace oraclegs
