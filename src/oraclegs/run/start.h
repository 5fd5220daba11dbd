#pragma once
// Starts a run, or opens one that was started.

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "oraclegs/scene/frame.h"
#include "oraclegs/stages/stage.h"

namespace oraclegs {

struct RunRequest {
  std::filesystem::path scene;  ///< folder of the user, only ever read
  /// Paths from the user, instead of `scene`: one folder, which is the scene, or photos, videos, zip archives and
  /// folders, which are imported to OUT/photos.
  std::vector<std::filesystem::path> inputs;
  std::filesystem::path out;  ///< workspace
  RunOptions options;
  bool estimates = false;                 ///< reports how long each stage up to the report will take
  bool overwrite = false;                 ///< removes the results of an earlier run from the workspace
  std::string version;                    ///< version of the program, for metrics.json
  std::function<void()> on_claimed = {};  ///< called when the workspace is held, before the first stage; may be empty
};

/// Reads a scene that has poses, into the frame that a run on it has. Throws InputError for a plain folder of photos.
PosedScene ReadPosedScene(const std::filesystem::path& root, const RunOptions& options, const Listener& listener);

/// Folder of a request that names exactly one. Throws UsageError otherwise.
std::filesystem::path OneFolder(const RunRequest& request);

/// Reads the scene (or imports it: stage "import", with warnings of photos that look unfit), settles the plan and the
/// size of the run, claims the workspace (workspace.h says when that is refused), finds poses for a plain folder of
/// photos (stage "register"), brings the scene into its frame, splits it, reports the split, and writes options.json
/// and split.json. Bad input is found before anything is written, except input that needs the import or the poses.
/// Options for weights that --allow-fallback replaced are changed in the run's options. From then on until the run's
/// end it writes live/ and train.csv. Throws UsageError, InputError or RunError.
Run StartRun(const RunRequest& request, const Listener& listener);

/// Opens the run in request.out, with the scene it was started on, to inspect or score its results; request.scene is
/// not read. Throws InputError when request.options differ in options that shape the result.
Run OpenRun(const RunRequest& request, const Listener& listener);

}  // namespace oraclegs
