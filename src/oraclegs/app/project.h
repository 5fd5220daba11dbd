#pragma once
// A project of the app: a folder with photos, what was asked for, and the run.

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "oraclegs/core/detached_program.h"

namespace oraclegs {

/// Edits that every export of a project makes, in the words of `oraclegs export`.
struct ExportEdits {
  std::string crop = "none";  ///< none, auto or box:x0,y0,z0,x1,y1,z1
  std::string up = "auto";    ///< auto, x, -x, y, -y, z or -z
  double scale = 0;           ///< 0 = auto
  double min_support = 0, max_uncertainty = 1;
  bool remove_outliers = false;
};

nlohmann::json EditsToJson(const ExportEdits& edits);
/// Takes the values that are there; the others stay. Throws InputError naming the first one that `oraclegs export`
/// would not take.
ExportEdits EditsFromJson(const nlohmann::json& json, ExportEdits edits);
/// The edits as options of `oraclegs export`.
std::vector<std::string> EditArguments(const ExportEdits& edits);

/// Facts of a project that its other files do not hold.
struct ProjectRecord {
  std::string name;
  std::string quality = "normal", device = "auto";  ///< of the last start
  int64_t queued = 0;                               ///< those that wait start in this order; 0 = it does not wait
  bool started = false;                             ///< a run was started at least once
  ProcessMark process;                              ///< of the last start
  ExportEdits edits;
};

/// Paths of a project's files. It touches no file.
class ProjectPaths {
 public:
  explicit ProjectPaths(std::filesystem::path root) : root_(std::move(root)) {}
  const std::filesystem::path& root() const { return root_; }
  std::filesystem::path record() const { return root_ / "project.json"; }
  std::filesystem::path photos() const { return root_ / "photos"; }    ///< as they were uploaded
  std::filesystem::path media() const { return root_ / "media"; }      ///< videos and zip archives
  std::filesystem::path splat() const { return root_ / "splat"; }      ///< workspace of the run
  std::filesystem::path exports() const { return root_ / "exports"; }  ///< files to download
  std::filesystem::path log() const { return root_ / "log.txt"; }      ///< output of the last start

 private:
  std::filesystem::path root_;
};

/// Reads project.json. A damaged one gives a record with the folder's name, so that photos and splat stay in reach.
ProjectRecord ReadProjectRecord(const ProjectPaths& paths);
/// Throws RunError.
void WriteProjectRecord(const ProjectPaths& paths, const ProjectRecord& record);

/// A name that people typed, made fit for a title: one line of UTF-8 without control characters, of at most 80
/// characters. Throws InputError when nothing is left.
std::string CleanName(const std::string& typed);

}  // namespace oraclegs
