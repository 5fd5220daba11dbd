#pragma once
// Record of a run beside its workspace: OUT/runs/NAME.json. Scores are in the run's own metrics.json, so that nothing
// is lost when this program is killed between the two.

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

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

}  // namespace oraclegs
