#pragma once
// Folder of one run: plain files that other tools can open, and the lock on them.

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "oraclegs/core/folder_lock.h"
#include "oraclegs/core/progress.h"
#include "oraclegs/scene/scene.h"
#include "oraclegs/settings/options.h"
#include "oraclegs/workspace/saved_run.h"

namespace oraclegs {

/// Paths of a run's files. It touches no file.
class WorkspacePaths {
 public:
  explicit WorkspacePaths(std::filesystem::path root) : root_(std::move(root)) {}

  const std::filesystem::path& root() const { return root_; }
  std::filesystem::path photos() const { return root_ / "photos"; }  ///< photos imported from the user's paths
  std::filesystem::path faces() const { return root_ / "faces"; }    ///< views that spherical photos were cut into
  std::filesystem::path photo_checks() const { return root_ / "photo_checks.json"; }
  std::filesystem::path options() const { return root_ / "options.json"; }  ///< scene and options of the run
  std::filesystem::path split() const { return root_ / "split.json"; }      ///< names of train and test views
  std::filesystem::path stages() const { return root_ / "stages.json"; }    ///< records of finished stages
  std::filesystem::path metrics() const { return root_ / "metrics.json"; }
  std::filesystem::path point_cloud() const { return root_ / "point_cloud.ply"; }
  std::filesystem::path exposures() const { return root_ / "exposures.json"; }
  std::filesystem::path frame() const { return root_ / "frame.json"; }  ///< coordinate frame of the run
  std::filesystem::path masks() const { return root_ / "masks"; }       ///< masks that the command of --masks made
  std::filesystem::path sfm() const { return root_ / "sfm"; }
  std::filesystem::path refined_poses() const { return sfm() / "refined.json"; }  ///< of the training views
  std::filesystem::path dense_ply() const { return sfm() / "dense.ply"; }
  std::filesystem::path depth() const { return root_ / "depth"; }
  std::filesystem::path proposals() const { return root_ / "proposals"; }
  std::filesystem::path confidence() const { return root_ / "confidence"; }
  std::filesystem::path checkpoints() const { return root_ / "checkpoints"; }
  std::filesystem::path report() const { return root_ / "report"; }            ///< files of the report and the viewer
  std::filesystem::path report_page() const { return root_ / "report.html"; }  ///< report as one file
  std::filesystem::path curves() const { return root_ / "train.csv"; }         ///< curves of the training
  std::filesystem::path live() const { return root_ / "live"; }  ///< state for observers while the run goes on
  std::filesystem::path renders(const std::string& path_name) const { return root_ / "renders" / path_name; }

 private:
  std::filesystem::path root_;
};

/// True when there are results that took long to make: a trained splat, scores or a checkpoint.
bool HasResults(const WorkspacePaths& paths);

/// Further content of options.json.
struct RunDetails {
  nlohmann::json size;                          ///< values of "auto" (settings/run_size.h); null = not known yet
  std::vector<std::filesystem::path> imported;  ///< inputs of a run whose scene is its own photos/
  bool may_train_on = true;  ///< a finished run may be continued with more --iterations or a higher --quality
};

/// A workspace held for writing; a second program that asks for the folder is refused meanwhile.
class Workspace : public WorkspacePaths {
 public:
  /// Claims `dir` for a run of `scene_root` with these options, and writes options.json. An empty or missing folder is
  /// taken. A folder with this run (same scene, same result-shaping options) is continued, also with more --iterations
  /// when it has trained to its end, or with a higher --quality, until whose splat is made the old one stays. With
  /// `overwrite` the files of a run of this program are removed first. Throws InputError naming the folder, the
  /// difference and the fix when it holds another run with results, or files of someone else, or lies in the scene
  /// folder; RunError when it cannot be written.
  static Workspace Claim(const std::filesystem::path& dir, const std::filesystem::path& scene_root,
                         const RunOptions& options, bool overwrite, const RunDetails& details = {});
  /// Writes the values of "auto" to options.json, for a run whose photos were not known when it was claimed.
  void SaveSize(const nlohmann::json& size) const;
  /// Drops damaged records from stages.json, with a warning: those stages count as not finished.
  void DropDamagedRecords(const Listener& listener) const;
  /// Holds an existing workspace unchanged. Throws InputError when `dir` is none, RunError when it cannot be written.
  static Workspace Open(const std::filesystem::path& dir);

  /// True when `stage` was finished from inputs of this key and its files (relative to the root) still exist.
  bool IsDone(const std::string& stage, const std::string& key) const;
  /// Record of a finished stage; null when it never finished.
  nlohmann::json Record(const std::string& stage) const;
  /// Throws RunError when the folder was removed or replaced while it is held.
  void RequireThere() const;
  /// Listener that passes events on and calls RequireThere at each step.
  Listener Watching(Listener listener) const;
  /// Records that `stage` is finished; the record must hold {"key", "seconds", "files": [...]}.
  void MarkDone(const std::string& stage, const nlohmann::json& record);
  /// Forgets that `stage` was finished, before its files are rewritten: after a kill halfway they are not used.
  void MarkUndone(const std::string& stage);

 private:
  explicit Workspace(const std::filesystem::path& dir);

  std::shared_ptr<const FolderLock> lock_;
};

/// Throws InputError when writing to `dir` would write into the user's scene folder.
void RequireOutsideScene(const std::filesystem::path& dir, const std::filesystem::path& scene_root);
/// Throws InputError likewise for the folders of its images, which may lie elsewhere, and for --images unless empty.
void RequireOutsideScene(const std::filesystem::path& dir, const Scene& scene, const std::filesystem::path& images);

/// Throws InputError unless `folder`, a folder of proposals, exists, has a name in UTF-8, and neither it nor `dir` lies
/// in the other.
void RequireApart(const std::filesystem::path& dir, const std::filesystem::path& folder);

}  // namespace oraclegs
