#pragma once
// Runs the colmap program's commands in a workspace folder and turns its output into events.

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "oraclegs/core/progress.h"
#include "oraclegs/core/subprocess.h"

namespace oraclegs {

/// True when the colmap program is installed.
bool ColmapAvailable();

/// A command of colmap ended with an error that the same images will meet again.
struct ColmapFailure {
  std::string command;
  int exit_code = 0;
  std::string last_line;  ///< last line of its output

  /// True when a signal ended the command.
  bool IsCrash() const { return exit_code > 128; }
  /// "colmap mapper ended with code 1: no good initial image pair found".
  std::string Text() const;
};

using ColmapOptions = std::map<std::string, std::string>;  ///< "SiftMatching.use_gpu" -> "0"

/// How `images` are matched: colmap walks through all pairs of blocks, and says when it is through with each.
struct MatchingBlocks {
  int images = 0, size = 2;

  int count() const { return (images + size - 1) / size; }  ///< along one axis
  int64_t pairs() const { return int64_t{images} * (images - 1) / 2; }
  /// Pairs of images matched when block (row, column), from 1, is done.
  int64_t PairsUpTo(int row, int column) const;
};

/// Blocks that are small enough to show progress and large enough to keep `threads` busy.
MatchingBlocks ChooseMatchingBlocks(int images, int threads);

/// Features are looked for in images reduced to this: more pixels cost memory (1.9 GB with two threads at this
/// size, 4.7 at colmap's own 3200) and find no more cameras.
inline constexpr int kMaxFeatureImageSide = 2000;

/// One workspace: a database of features and matches below work_dir, the images in work_dir/images, all output appended
/// to work_dir/colmap.log. The database's folder exists. Progress is reported as that of `stage`, `label` before it.
class ColmapRunner {
 public:
  ColmapRunner(std::filesystem::path work_dir, const Listener& listener, std::string stage,
               std::string database = "database.db", std::string label = "")
      : work_dir_(std::move(work_dir)),
        database_(std::move(database)),
        stage_(std::move(stage)),
        label_(std::move(label)),
        listener_(listener) {}

  std::filesystem::path database() const { return work_dir_ / database_; }
  const std::string& label() const { return label_; }
  std::filesystem::path images() const { return work_dir_ / "images"; }

  /// One camera per folder below images/; masks/ is used when has_masks. Options in `more` come first.
  void ExtractFeatures(const std::string& camera_model, bool has_masks, const ColmapOptions& more = {}) const;
  /// Every pair of images, in blocks whose ends are reported as pairs done. Not the same matches in every run.
  void MatchExhaustively(const ColmapOptions& more = {}) const;
  /// The pairs of names (below images/, without blanks) that the database has no matches of yet.
  void MatchPairs(const std::vector<std::pair<std::string, std::string>>& names, const ColmapOptions& more,
                  const std::string& what) const;
  /// Matches that colmap verifies and writes: of each pair a line of two names, lines of two indices of keypoints, and
  /// an empty one. The database has none of these pairs yet.
  void ImportMatches(const std::filesystem::path& list, int64_t pairs, const std::string& what) const;
  /// Poses, intrinsics and points of a model refined together; reads no database.
  void AdjustBundle(const std::filesystem::path& model, const std::filesystem::path& adjusted) const;
  /// Poses and points of a model refined together, the intrinsics and the turns between a rig's cameras fixed; reads no
  /// database. `rigs`: JSON as rig_bundle_adjuster of COLMAP 3.8 reads it.
  void AdjustRigs(const std::filesystem::path& model, const std::filesystem::path& rigs,
                  const std::filesystem::path& adjusted) const;
  /// The model without images of these names, adjusted anew, since the poses of the others were found together with
  /// theirs; reads no database. It is written below `folder`; empty where colmap leaves no model.
  std::filesystem::path WithoutImages(const std::filesystem::path& model, const std::vector<std::string>& names,
                                      const std::filesystem::path& folder) const;
  /// Any command that works on the database; an interrupt ends it. Throws ColmapFailure when it ends with an error, and
  /// RunError when it was killed, twice did nothing for StallLimit(), printed nothing for half an hour, or the disk is
  /// full.
  void Run(const std::string& command, const ColmapOptions& options, const std::string& what) const;

 private:
  /// Words and numbers to report a command by; blocks of no images where it does not match all pairs.
  struct Task {
    std::string what;
    MatchingBlocks blocks;
    int64_t pairs = 0;         ///< pairs of a list that it matches
    bool is_repeated = false;  ///< after a first try that did nothing
  };
  /// Runs a command line with these options, which newer versions of colmap get by their own names.
  void Execute(const std::vector<std::string>& command_line, const ColmapOptions& options, const Task& task) const;
  [[noreturn]] void Stop(const std::string& command, const std::string& why, const std::string& last_line) const;

  std::filesystem::path work_dir_;
  std::string database_, stage_, label_;
  const Listener& listener_;
};

}  // namespace oraclegs
