#pragma once
// Starts a run, or opens one that was started.

#include <filesystem>
#include <functional>
#include <string>

#include "oraclegs/pipeline/stages/stage.h"

namespace oraclegs {

struct RunRequest {
  std::filesystem::path scene;  ///< the user's folder, only ever read
  std::filesystem::path out;    ///< the workspace
  RunOptions options;
  bool overwrite = false;                 ///< remove what an earlier run left in the workspace
  std::string version;                    ///< of the program, for metrics.json
  std::function<void()> on_claimed = {};  ///< called when the workspace is held, before the first stage; may be empty
};

/// A scene with poses, and which of its views train and test.
struct PosedScene {
  Scene scene;
  Split split;
};

/// Reads a scene that has poses of its own. Throws InputError for a plain folder of photos.
PosedScene ReadPosedScene(const std::filesystem::path& root, const RunOptions& options, const Listener& listener);

/// Reads the scene, settles the plan, claims the workspace (workspace.h says when that is refused), finds poses for a
/// plain folder of photos (stage "register"), splits, reports the split, and writes options.json and split.json. Bad
/// input is found before anything is written, except what needs the poses. Weights that --allow-fallback does without
/// are not in the run's options. From then on until the run's end it writes live/ and curves.csv. Throws UsageError,
/// InputError or RunError.
Run StartRun(const RunRequest& request, const Listener& listener);

/// The run that stands in request.out, with the scene it was started on, to look at its results or to score them;
/// request.scene is not read. Throws InputError when request.options differ in what shapes the result.
Run OpenRun(const RunRequest& request, const Listener& listener);

}  // namespace oraclegs
