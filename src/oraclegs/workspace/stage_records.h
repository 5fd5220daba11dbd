#pragma once
// stages.json: what each finished stage left to remember.

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace oraclegs {

struct StageRecords {
  nlohmann::json by_stage = nlohmann::json::object();  ///< sound records alone: who reads them need not check types
  std::vector<std::string> damaged;                    ///< names of the others
  bool is_readable = true;                             ///< false: the file is there and is no such file
};

/// What stages.json of a workspace holds; nothing where there is none.
StageRecords InspectStageRecords(const std::filesystem::path& workspace);

/// Its sound records alone.
nlohmann::json ReadStageRecords(const std::filesystem::path& workspace);

}  // namespace oraclegs
