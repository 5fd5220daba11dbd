#include "oraclegs/sfm/colmap_runner.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <string_view>
#include <utility>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/host.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/core/text.h"
#include "oraclegs/sfm/colmap_database.h"
#include "oraclegs/sfm/colmap_option_names.h"
#include "oraclegs/sfm/colmap_workspace.h"

namespace oraclegs {
namespace {

/// The line without what sets the color of a terminal ("\033[0;31m"), as newer versions write it even into a pipe.
std::string WithoutColor(std::string line) {
  for (size_t begin = 0, end = 0; (begin = line.find("\033[", begin)) != std::string::npos;) {
    end = line.find('m', begin);
    line.erase(begin, end == std::string::npos ? end : end + 1 - begin);
  }
  return line;
}

/// A line for people: without colors, the blanks before it and glog's "F20261122 08:06:59.9 11264 sfm.cc:473] "; "" of
/// the stack of a crash, which follows the line with its cause.
std::string Readable(const std::string& colored) {
  const std::string line = WithoutColor(colored);
  const size_t begin = line.find_first_not_of(" \t");
  if (begin == std::string::npos || line[begin] == '@' || line.compare(begin, 3, "***") == 0) return "";
  const size_t end = line.find("] ");
  const bool has_prefix = std::string_view("IWEF").find(line[0]) != std::string_view::npos && line.size() > 9 &&
                          std::all_of(line.begin() + 1, line.begin() + 9, [](char c) { return c >= '0' && c <= '9'; });
  return line.substr(has_prefix && end != std::string::npos ? end + 2 : begin);
}

/// Follows one command's lines: "Processed file [3/12]", "Matching block [1/1, 1/1]" ("Processing block" since COLMAP
/// 3.9), "Registering image #7 (4)".
class ProgressReader {
 public:
  /// `listed`: pairs of a list, that are matched.
  ProgressReader(std::string stage, std::string what, const MatchingBlocks& blocks, int64_t listed,
                 const Listener& listener)
      : stage_(std::move(stage)), what_(std::move(what)), blocks_(blocks), listed_(listed), listener_(listener) {
    if (blocks_.images > 1) listener_(StepDone{stage_, 0, blocks_.pairs(), "pairs", what_});
    if (listed_ > 0) listener_(StepDone{stage_, 0, listed_, "pairs", what_});
  }

  void operator()(const std::string& line) {
    const std::string said = Readable(line);
    if (said.empty()) return;
    last_line_ = said;
    int done = 0, total = 0;
    if (std::sscanf(said.c_str(), "Processed file [%d/%d]", &done, &total) == 2) {
      listener_(StepDone{stage_, done, total, "images", what_});
    } else if (int column = 0, columns = 0;
               std::sscanf(said.c_str(), "%*s block [%d/%d, %d/%d]", &done, &total, &column, &columns) == 4) {
      if (blocks_.images > 1) {  // the line ends when the block is done
        listener_(StepDone{stage_, blocks_.PairsUpTo(done, column), blocks_.pairs(), "pairs", what_});
      }
    } else if (listed_ > 0 && std::sscanf(said.c_str(), "%*s block [%d/%d]", &done, &total) == 2 && total > 0) {
      listener_(StepDone{stage_, listed_ * done / total, listed_, "pairs", what_});
    } else if (said.rfind("Registering image #", 0) == 0 || said.rfind("Triangulating image #", 0) == 0) {
      listener_(StepDone{stage_, ++images_, 0, "images", what_});
    }
  }

  const std::string& last_line() const { return last_line_; }

 private:
  std::string stage_, what_;
  MatchingBlocks blocks_;
  int64_t listed_;
  const Listener& listener_;
  std::string last_line_;
  int images_ = 0;
};

RefusedNames g_refused_names;

/// As many threads as fit into half of the free memory.
int ExtractionThreads() {
  constexpr uint64_t kBytesPerThread = uint64_t{900} << 20;  // at kMaxFeatureImageSide
  const uint64_t fit = AvailableMemory() / 2 / kBytesPerThread;
  return static_cast<int>(std::clamp<uint64_t>(fit, 1, static_cast<uint64_t>(NumThreads())));
}

ColmapOptions MatchingOptions() {
  return {{"SiftMatching.use_gpu", "0"}, {"SiftMatching.num_threads", std::to_string(NumThreads())}};
}

constexpr std::chrono::minutes kLongestSilence{30};

std::string LastWords(const std::string& line) {
  return line.empty() ? "" : fmt::format(" (it said last: {})", Printable(line));
}

bool IsDiskFull(const std::string& output) {
  return output.find("disk is full") != std::string::npos || output.find("No space left") != std::string::npos;
}

bool IsOutOfMemory(const std::string& output) {
  return output.find("bad_alloc") != std::string::npos || output.find("Cannot allocate memory") != std::string::npos;
}

}  // namespace

std::string ColmapFailure::Text() const {
  const std::string how =
      IsCrash() ? fmt::format("crashed (signal {})", exit_code - 128) : fmt::format("ended with code {}", exit_code);
  return fmt::format("colmap {} {}{}", command, how, last_line.empty() ? "" : ": " + Printable(last_line));
}

int64_t MatchingBlocks::PairsUpTo(int row, int column) const {
  // Colmap gives a pair (i, j) of positions inside two blocks to one of the two orders of these blocks.
  int64_t pairs = 0;
  for (int r = 0; r < row; ++r) {
    for (int c = 0; c < (r + 1 == row ? column : count()); ++c) {
      for (int i = r * size; i < std::min(images, (r + 1) * size); ++i) {
        for (int j = c * size; j < std::min(images, (c + 1) * size); ++j) {
          const int at_i = i % size, at_j = j % size;
          pairs += (i > j && at_i <= at_j) || (i < j && at_i < at_j);
        }
      }
    }
  }
  return pairs;
}

MatchingBlocks ChooseMatchingBlocks(int images, int threads) {
  constexpr int kMaxBlocks = 10;  // along one axis: 100 reports
  MatchingBlocks blocks{images, std::max(2, images)};
  const double pairs_at_once = 2.0 * std::max(2, threads);
  const int wanted =
      std::clamp(static_cast<int>(std::sqrt(static_cast<double>(blocks.pairs()) / pairs_at_once)), 1, kMaxBlocks);
  blocks.size = std::max(2, (images + wanted - 1) / wanted);
  return blocks;
}

bool ColmapAvailable() { return !FindProgram("colmap").empty(); }

void ColmapRunner::Run(const std::string& command, const ColmapOptions& options, const std::string& what) const {
  Execute({"colmap", command, "--database_path", database().string()}, options, {what, {}, 0});
}

void ColmapRunner::Execute(const std::vector<std::string>& command_line, const ColmapOptions& options,
                           const Task& task) const {
  const std::string program = FindProgram("colmap").string();
  std::vector<std::string> argv = command_line;
  for (const auto& [name, value] : options) {
    argv.push_back("--" + g_refused_names.NameFor(program, name));
    argv.push_back(value);
  }
  ProgressReader progress(stage_, label_ + task.what, task.blocks, task.pairs, listener_);
  const std::string command = argv[1];
  auto last_sign = std::chrono::steady_clock::now();
  ProcessRequest request;
  request.argv = std::move(argv);
  request.log = work_dir_ / "colmap.log";
  // Else its logging leaves files in the temporary folder; some commands do so although they are set to print.
  request.variables = {{"GLOG_logtostderr", "1"}, {"GLOG_log_dir", AttemptsFolder(work_dir_).string()}};
  request.stall_limit = StallLimit();
  request.on_line = [&](const std::string& line) {
    last_sign = std::chrono::steady_clock::now();
    progress(line);
  };
  request.while_running = [&] {
    if (std::chrono::steady_clock::now() - last_sign > kLongestSilence) {
      Stop(command, "printed nothing for half an hour and was ended", progress.last_line());
    }
  };
  const ProcessResult result = RunProcess(request);
  if (result.stalled) {
    const std::string stalled = fmt::format("did nothing for {:g} s and was ended", request.stall_limit->count());
    if (!task.is_repeated) {
      // Its threads may wait for each other; the features and matches that it wrote are not computed again.
      listener_(Warning{fmt::format("colmap {} {}; it is started once more", command, stalled)});
      Task repeated = task;
      repeated.is_repeated = true;
      return Execute(command_line, options, repeated);
    }
    Stop(command, stalled + " (more patience: ORACLEGS_STALL_LIMIT=SECONDS)", progress.last_line());
  }
  if (result.exit_code == 0) return;
  if (g_refused_names.Learn(program, progress.last_line())) return Execute(command_line, options, task);
  if (IsDiskFull(result.output)) Stop(command, "found no space left on the disk; make room", progress.last_line());
  if (result.output.find("disk I/O error") != std::string::npos) {
    Stop(command, "could not write to the disk; check it, and make room there", progress.last_line());
  }
  if (IsOutOfMemory(result.output)) Stop(command, "ran out of memory; close other programs", progress.last_line());
  if (WasKilled(result.exit_code)) {
    Stop(command, "was killed from outside, as happens when memory runs out", progress.last_line());
  }
  throw ColmapFailure{command, result.exit_code, progress.last_line()};
}

void ColmapRunner::Stop(const std::string& command, const std::string& why, const std::string& last_line) const {
  throw RunError("colmap {} {}; run the same command again{}; see {}", command, why, LastWords(last_line),
                 (work_dir_ / "colmap.log").string());
}

void ColmapRunner::ExtractFeatures(const std::string& camera_model, bool has_masks, const ColmapOptions& more) const {
  ColmapOptions options = more;
  options.insert({{"image_path", images().string()},
                  {"ImageReader.single_camera_per_folder", "1"},
                  {"ImageReader.camera_model", camera_model},
                  {"SiftExtraction.use_gpu", "0"},
                  {"SiftExtraction.max_image_size", std::to_string(kMaxFeatureImageSide)},
                  {"SiftExtraction.num_threads", std::to_string(ExtractionThreads())}});
  if (has_masks) options["ImageReader.mask_path"] = (work_dir_ / "masks").string();
  Run("feature_extractor", options, "finding features");
  NumberImagesByName(database());
}

void ColmapRunner::MatchExhaustively(const ColmapOptions& more) const {
  // Not guided: on a CPU that takes five times as long. The matches differ a little from run to run, even with one
  // thread: colmap's approximate neighbor search draws its seed from the machine. The cached result does not.
  ColmapOptions options = MatchingOptions();
  options.insert(more.begin(), more.end());
  const auto images = static_cast<int>(ReadDatabaseImages(database()).size());
  const MatchingBlocks blocks = ChooseMatchingBlocks(images, NumThreads());
  options["ExhaustiveMatching.block_size"] = std::to_string(blocks.size);
  Execute({"colmap", "exhaustive_matcher", "--database_path", database().string()}, options, {"matching", blocks, 0});
}

void ColmapRunner::MatchPairs(const std::vector<std::pair<std::string, std::string>>& names, const ColmapOptions& more,
                              const std::string& what) const {
  std::string list;
  for (const auto& [a, b] : names) list += a + " " + b + "\n";
  const std::filesystem::path path = database().parent_path() / "pairs.txt";
  WriteFileAtomically(path, list);
  ColmapOptions options = MatchingOptions();
  options.insert(more.begin(), more.end());
  options["match_list_path"] = path.string();
  options["match_type"] = "pairs";
  Execute({"colmap", "matches_importer", "--database_path", database().string()}, options,
          {what, {}, static_cast<int64_t>(names.size())});
}

void ColmapRunner::ImportMatches(const std::filesystem::path& list, int64_t pairs, const std::string& what) const {
  ColmapOptions options = MatchingOptions();
  options["match_list_path"] = list.string();
  options["match_type"] = "raw";
  Execute({"colmap", "matches_importer", "--database_path", database().string()}, options, {what, {}, pairs});
}

void ColmapRunner::AdjustBundle(const std::filesystem::path& model, const std::filesystem::path& adjusted) const {
  Execute({"colmap", "bundle_adjuster"}, {{"input_path", model.string()}, {"output_path", adjusted.string()}},
          {"adjusting", {}, 0});
}

void ColmapRunner::AdjustRigs(const std::filesystem::path& model, const std::filesystem::path& rigs,
                              const std::filesystem::path& adjusted) const {
  Execute({"colmap", "rig_bundle_adjuster"},
          {{"input_path", model.string()},
           {"output_path", adjusted.string()},
           {"rig_config_path", rigs.string()},
           {"estimate_rig_relative_poses", "0"},
           {"RigBundleAdjustment.refine_relative_poses", "0"},
           {"BundleAdjustment.refine_focal_length", "0"},
           {"BundleAdjustment.refine_extra_params", "0"},
           {"BundleAdjustment.function_tolerance", "1e-7"}},
          {"adjusting the spheres", {}, 0});
}

std::filesystem::path ColmapRunner::WithoutImages(const std::filesystem::path& model,
                                                  const std::vector<std::string>& names,
                                                  const std::filesystem::path& folder) const {
  const std::filesystem::path list = folder / "left_out.txt", rest = folder / "rest", adjusted = folder / "adjusted";
  WriteFileAtomically(list, fmt::format("{}\n", fmt::join(names, "\n")));
  for (const std::filesystem::path& made : {rest, adjusted}) MakeFolder(made);
  Execute({"colmap", "image_deleter"},
          {{"input_path", model.string()}, {"output_path", rest.string()}, {"image_names_path", list.string()}},
          {"leaving photos out", {}, 0});
  if (!IsColmapModel(rest)) return {};
  AdjustBundle(rest, adjusted);
  return IsColmapModel(adjusted) ? adjusted : std::filesystem::path();
}

}  // namespace oraclegs
