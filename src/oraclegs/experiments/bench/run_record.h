#pragma once
// Record of a run beside its workspace: OUT/runs/NAME.json. Scores are in the run's own metrics.json, so that nothing
// is lost when this program is killed between the two.

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "oraclegs/core/progress.h"
#include "oraclegs/experiments/bench/bench_plan.h"
#include "oraclegs/experiments/bench/bench_table.h"
#include "oraclegs/experiments/launch/launcher.h"

namespace oraclegs {

struct RunRecord {
  std::string scene;         ///< absolute
  nlohmann::json arguments;  ///< ResultArguments
  std::string version;       ///< version of the program that started it
  bool ended = false;        ///< true when a call saw it end
  JobResult result = {};     ///< valid once ended
};

std::filesystem::path RecordFile(const std::filesystem::path& workspace);
std::filesystem::path LogFile(const std::filesystem::path& workspace);

/// nullopt when the record is missing or damaged.
std::optional<RunRecord> ReadRunRecord(const std::filesystem::path& workspace);
/// Throws RunError.
void WriteRunRecord(const std::filesystem::path& workspace, const RunRecord& record);

/// Value as it is read back: JSON replaces bytes that are not UTF-8.
nlohmann::json AsRecorded(const nlohmann::json& value);

/// Fills in the scores of the workspace's metrics.json. Returns false and changes nothing where the file is missing or
/// damaged: the run is not done.
bool ReadScore(const std::filesystem::path& workspace, BenchScore* score);

inline constexpr char kSlurmFolder[] = "slurm";  ///< folder of --launcher slurm in a benchmark's folder

/// Removes the workspaces, records and logs of the plan's runs, for --overwrite. It first cancels and forgets
/// everything that earlier calls in request.out still have in Slurm's queue, which would be taken for runs of this
/// call. Throws RunError before anything is removed when a run still works or the queue cannot be reached; RunError
/// also when something cannot be removed; and as CancelOpenSlurmTasks.
void RemoveRuns(const BenchRequest& request, const BenchPlan& plan, const Listener& listener);

}  // namespace oraclegs
