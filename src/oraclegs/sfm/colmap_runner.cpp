#include "oraclegs/sfm/colmap_runner.h"

#include <algorithm>
#include <cstdio>
#include <string_view>
#include <utility>

#include "oraclegs/core/files.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/sfm/colmap_database.h"

namespace oraclegs {
namespace {

/// A line for people: without the blanks before it and glog's "F20261122 08:06:59.9 11264 sfm.cc:473] "; "" of
/// the stack of a crash, which follows the line with its cause.
std::string Readable(const std::string& line) {
  const size_t begin = line.find_first_not_of(" \t");
  if (begin == std::string::npos || line[begin] == '@' || line.compare(begin, 3, "***") == 0) return "";
  const size_t end = line.find("] ");
  const bool has_prefix = std::string_view("IWEF").find(line[0]) != std::string_view::npos && line.size() > 9 &&
                          std::all_of(line.begin() + 1, line.begin() + 9, [](char c) { return c >= '0' && c <= '9'; });
  return line.substr(has_prefix && end != std::string::npos ? end + 2 : begin);
}

/// Follows one command's lines: "Processed file [3/12]", "Matching block [1/1, 1/1]", "Registering image #7 (4)".
class ProgressReader {
 public:
  ProgressReader(std::string what, const Listener& listener) : what_(std::move(what)), listener_(listener) {}

  void operator()(const std::string& line) {
    if (std::string readable = Readable(line); !readable.empty()) last_line_ = std::move(readable);
    int done = 0, total = 0;
    if (std::sscanf(line.c_str(), "Processed file [%d/%d]", &done, &total) == 2) {
      listener_(StepDone{"sfm", done, total, "images", what_});
    } else if (std::sscanf(line.c_str(), "Matching block [%d/%d", &done, &total) == 2) {
      listener_(StepDone{"sfm", done, total, "blocks", what_});
    } else if (line.rfind("Registering image #", 0) == 0 || line.rfind("Triangulating image #", 0) == 0) {
      listener_(StepDone{"sfm", ++images_, 0, "images", what_});
    }
  }

  const std::string& last_line() const { return last_line_; }

 private:
  std::string what_;
  const Listener& listener_;
  std::string last_line_;
  int images_ = 0;
};

ColmapOptions MatchingOptions() {
  return {{"SiftMatching.use_gpu", "0"}, {"SiftMatching.num_threads", std::to_string(NumThreads())}};
}

}  // namespace

bool ColmapAvailable() { return !FindProgram("colmap").empty(); }

void ColmapRunner::Run(const std::string& command, const ColmapOptions& options, const std::string& what) const {
  Execute({"colmap", command, "--database_path", database().string()}, options, what);
}

void ColmapRunner::Execute(std::vector<std::string> argv, const ColmapOptions& options, const std::string& what) const {
  for (const auto& [name, value] : options) {
    argv.push_back("--" + name);
    argv.push_back(value);
  }
  ProgressReader progress(what, listener_);
  const ProcessResult result =
      RunProcess(argv, work_dir_ / "colmap.log", [&](const std::string& line) { progress(line); });
  if (result.exit_code != 0) throw ColmapFailure{argv[1], result.exit_code, progress.last_line()};
}

void ColmapRunner::ExtractFeatures(const std::string& camera_model, bool has_masks, const ColmapOptions& more) const {
  ColmapOptions options{{"image_path", images().string()},
                        {"ImageReader.single_camera_per_folder", "1"},
                        {"ImageReader.camera_model", camera_model},
                        {"SiftExtraction.use_gpu", "0"},
                        {"SiftExtraction.num_threads", std::to_string(NumThreads())}};
  if (has_masks) options["ImageReader.mask_path"] = (work_dir_ / "masks").string();
  options.insert(more.begin(), more.end());
  Run("feature_extractor", options, "finding features");
  NumberImagesByName(database());
}

void ColmapRunner::MatchExhaustively(const ColmapOptions& more) const {
  // Not guided: on a CPU that takes five times as long. The matches differ a little from run to run, even with one
  // thread: colmap's approximate neighbour search draws its seed from the machine. The cached result does not.
  ColmapOptions options = MatchingOptions();
  options.insert(more.begin(), more.end());
  Run("exhaustive_matcher", options, "matching");
}

void ColmapRunner::MatchPairs(const std::vector<std::pair<std::string, std::string>>& names,
                              const ColmapOptions& more) const {
  std::string list;
  for (const auto& [a, b] : names) list += a + " " + b + "\n";
  const std::filesystem::path path = database().parent_path() / "pairs.txt";
  WriteFileAtomically(path, list);
  ColmapOptions options = MatchingOptions();
  options.insert(more.begin(), more.end());
  options["match_list_path"] = path.string();
  options["match_type"] = "pairs";
  Run("matches_importer", options, "matching again");
}

void ColmapRunner::AdjustBundle(const std::filesystem::path& model, const std::filesystem::path& adjusted) const {
  Execute({"colmap", "bundle_adjuster"}, {{"input_path", model.string()}, {"output_path", adjusted.string()}},
          "adjusting");
}

}  // namespace oraclegs
