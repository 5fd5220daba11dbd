#pragma once
// What a benchmark remembers of a run, beside its workspace: OUT/runs/NAME.json. What the run scored stands in its own
// metrics.json, so that nothing is lost when this program is killed between the two.

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
  std::string version;       ///< of the program that started it
  bool ended = false;        ///< in a call that lived to see it
  JobResult result = {};     ///< then
};

std::filesystem::path RecordFile(const std::filesystem::path& workspace);
std::filesystem::path LogFile(const std::filesystem::path& workspace);

/// Nothing where there is none, or it is damaged.
std::optional<RunRecord> ReadRunRecord(const std::filesystem::path& workspace);
/// Throws RunError.
void WriteRunRecord(const std::filesystem::path& workspace, const RunRecord& record);

/// A text or options as they are read back: JSON holds no bytes that are not UTF-8, they are replaced.
nlohmann::json AsRecorded(const nlohmann::json& value);

/// Fills in what metrics.json of the workspace says. False, and nothing is changed, where it is missing or damaged: the
/// run is not done.
bool ReadScore(const std::filesystem::path& workspace, BenchScore* score);

}  // namespace oraclegs
