#pragma once
// stages.json: the records of finished stages.

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace oraclegs {

struct StageRecords {
  nlohmann::json by_stage = nlohmann::json::object();  ///< sound records only: readers need not check types
  std::vector<std::string> damaged;                    ///< names of the others
  bool is_readable = true;                             ///< false = the file exists and is not in this format
};

/// Records in stages.json of a workspace; empty without the file.
StageRecords InspectStageRecords(const std::filesystem::path& workspace);

/// Sound records of stages.json.
nlohmann::json ReadStageRecords(const std::filesystem::path& workspace);

}  // namespace oraclegs
