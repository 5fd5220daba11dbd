#pragma once
// One run: a scene with poses and a split, its options, and the workspace its stages write to.

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "oraclegs/core/progress.h"
#include "oraclegs/pipeline/settings/options.h"
#include "oraclegs/pipeline/workspace/workspace.h"
#include "oraclegs/scene/scene.h"
#include "oraclegs/scene/split.h"

namespace oraclegs {

struct RunRequest {
  std::filesystem::path scene;  ///< the user's folder, only ever read
  std::filesystem::path out;    ///< the workspace
  RunOptions options;
  bool overwrite = false;  ///< remove what an earlier run left in the workspace
  std::string version;     ///< of the program, for metrics.json
};

/// A scene with poses, and which of its views train and test.
struct PosedScene {
  Scene scene;
  Split split;
};

/// Reads a scene that has poses of its own. Throws InputError for a plain folder of photographs.
PosedScene ReadPosedScene(const std::filesystem::path& root, const RunOptions& options, const Listener& listener);

struct Run {
  RunOptions options;
  std::string version;
  Workspace workspace;
  Scene scene;  ///< has poses
  Split split;
  Listener listener;
};

/// Reads the scene, claims the workspace (workspace.h says when that is refused), finds poses for a plain folder of
/// photographs (stage "register", sfm/), splits, tells the split, and writes options.json and split.json. Bad input is
/// found before anything is written, except what needs the poses. Weights that --allow-fallback does without are not in
/// the run's options. Throws UsageError, InputError or RunError.
Run StartRun(const RunRequest& request, const Listener& listener);

/// The run that stands in request.out, with the scene it was started on; request.scene is not read. Throws InputError
/// when request.options differ in what shapes the result.
Run OpenRun(const RunRequest& request, const Listener& listener);

/// Tells the beginning of a stage, and on Finish its end.
class StageClock {
 public:
  StageClock(std::string stage, const Listener& listener);
  double Seconds() const;
  /// Returns the seconds since the beginning.
  double Finish() const;

 private:
  std::string stage_;
  const Listener& listener_;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace oraclegs
