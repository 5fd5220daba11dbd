#include "oraclegs/experiments/bench/run_record.h"

#include <algorithm>
#include <chrono>
#include <filesystem>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/folder_lock.h"
#include "oraclegs/core/unique_json.h"
#include "oraclegs/experiments/launch/slurm_record.h"
#include "oraclegs/workspace/saved_run.h"
#include "oraclegs/workspace/workspace.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr uint64_t kMaxBytes = 64 << 20;

/// Content of a JSON file; a discarded value when it cannot be read.
json ReadJsonFile(const fs::path& file) {
  try {
    return ParseJsonOrDiscard(ReadFile(file, kMaxBytes));
  } catch (const InputError&) {
    return json(json::value_t::discarded);
  }
}

std::optional<double> NumberIn(const json& object, const char* name) {
  const json value = object.value(name, json());
  return value.is_number() ? std::optional(value.get<double>()) : std::nullopt;
}

/// Wall time from photos to the trained model, seconds.
double SecondsOf(const json& metrics) {
  double seconds = 0;
  const json stages = metrics.value("stages", json::object());
  for (const auto& [stage, record] : stages.items()) {
    if (stage != "evaluate" && record.is_object()) seconds += NumberIn(record, "seconds").value_or(0);
  }
  return seconds;
}

/// Processor time from photos to the trained model, seconds; nullopt where a stage has none.
std::optional<double> CpuSecondsOf(const json& metrics) {
  double seconds = 0;
  const json stages = metrics.value("stages", json::object());
  for (const auto& [stage, record] : stages.items()) {
    if (stage == "evaluate") continue;
    const auto own = record.is_object() ? NumberIn(record, "cpu_seconds") : std::nullopt;
    if (!own) return std::nullopt;
    seconds += *own;
  }
  return stages.empty() ? std::nullopt : std::optional(seconds);
}

fs::path Beside(const fs::path& workspace, const char* extension) {
  fs::path file = workspace;
  return file += extension;  // replace_extension would not do: the name of a scene may contain dots
}

namespace fs = std::filesystem;

// Another machine of a cluster may release a lock a little after its task has ended.
constexpr std::chrono::seconds kWorkspacePatience{2};

void RequireIdle(const fs::path& workspace) {
  const FolderLock lock(workspace, kWorkspacePatience);
  if (lock.state() != FolderLock::State::kHeldByAnother) return;
  throw RunError("{}: another oraclegs still works there ({}); wait for it or end it, then run the same command again",
                 workspace.string(), lock.holder());
}

/// Removes a file or a whole folder, if it exists.
void Remove(const fs::path& path) {
  std::error_code error;
  fs::remove_all(path, error);
  if (!error) return;
  throw RunError("{}: cannot be removed: {}; remove it, then run the same command again", path.string(),
                 error.message());
}

}  // namespace

fs::path RecordFile(const fs::path& workspace) { return Beside(workspace, ".json"); }
fs::path LogFile(const fs::path& workspace) { return Beside(workspace, ".log"); }

std::optional<RunRecord> ReadRunRecord(const fs::path& workspace) {
  const json file = ReadJsonFile(RecordFile(workspace));
  if (!file.is_object() || file.value("program", json()) != "oraclegs") return std::nullopt;
  const auto text = [&](const char* name) {
    const json value = file.value(name, json());
    return value.is_string() ? value.get<std::string>() : std::string();
  };
  RunRecord record{text("scene"), file.value("options", json::object()), text("version")};
  if (!record.arguments.is_object()) return std::nullopt;
  record.ended = file.value("ended", json()) == true;
  record.result.seconds = NumberIn(file, "seconds").value_or(0);
  record.result.peak_bytes = static_cast<int64_t>(NumberIn(file, "peak_bytes").value_or(0));
  record.result.exit_code = static_cast<int>(NumberIn(file, "exit_code").value_or(0));
  record.result.why = text("why");
  return record;
}

void WriteRunRecord(const fs::path& workspace, const RunRecord& record) {
  const json file = {{"program", "oraclegs"},
                     {"scene", record.scene},
                     {"options", record.arguments},
                     {"version", record.version},
                     {"ended", record.ended},
                     {"exit_code", record.result.exit_code},
                     {"seconds", record.result.seconds},
                     {"peak_bytes", record.result.peak_bytes},
                     {"why", record.result.why}};
  WriteFileAtomically(RecordFile(workspace), file.dump(2, ' ', false, json::error_handler_t::replace) + "\n");
}

json AsRecorded(const json& value) { return json::parse(value.dump(-1, ' ', false, json::error_handler_t::replace)); }

bool ReadScore(const fs::path& workspace, BenchScore* score) {
  const json metrics = ReadJsonFile(WorkspacePaths(workspace).metrics());
  if (!metrics.is_object() || !metrics.contains("gaussians")) return false;
  const json test = metrics.value("test", json());
  if (!test.is_object() || !test.contains("psnr")) return false;
  const auto set = [&](BenchValue value, std::optional<double> number) {
    score->value[static_cast<size_t>(value)] = number;
  };
  set(BenchValue::kPsnr, NumberIn(test, "psnr")), set(BenchValue::kSsim, NumberIn(test, "ssim"));
  set(BenchValue::kLpips, NumberIn(test, "lpips")), set(BenchValue::kSeconds, SecondsOf(metrics));
  set(BenchValue::kCpuSeconds, CpuSecondsOf(metrics));
  set(BenchValue::kPeakBytes, NumberIn(metrics, "peak_memory_bytes"));
  set(BenchValue::kGaussians, NumberIn(metrics, "gaussians"));
  const json train = metrics.value("train", json::object()), views = metrics.value("views", json::object());
  const json conventions = test.value("conventions", json::object());
  if (train.is_object()) score->training_seconds = NumberIn(train, "seconds").value_or(0);
  if (views.is_object()) score->train_views = static_cast<size_t>(NumberIn(views, "train").value_or(0));
  if (conventions.is_object() && conventions.value("lpips", json()).is_string()) {
    score->lpips = conventions["lpips"].get<std::string>();
  }
  score->failure.clear();
  score->ended = true;
  return true;
}

void RemoveRuns(const BenchRequest& request, const BenchPlan& plan, const Listener& listener) {
  const fs::path slurm = request.out / kSlurmFolder;
  CancelOpenSlurmTasks(slurm, listener);
  for (const BenchRun& run : plan.runs) RequireIdle(WorkspaceOf(request, run));
  if (HasSlurmRecord(slurm)) Remove(slurm);
  for (const BenchRun& run : plan.runs) {
    const fs::path workspace = WorkspaceOf(request, run);
    if (IsWorkspace(workspace)) Remove(workspace);
    Remove(RecordFile(workspace));
    Remove(LogFile(workspace));
  }
}

}  // namespace oraclegs
