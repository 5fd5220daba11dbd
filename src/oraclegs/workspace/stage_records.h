#pragma once
// stages.json: the records of finished stages.

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "oraclegs/core/progress.h"

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

/// Name of the record of a point cloud that is not the result of its run: {"of": what it shows instead}.
inline constexpr char kBestSoFar[] = "best so far";

/// Names what point_cloud.ply of a stopped run shows instead of its result, as "draft model"; "" = it is the result.
std::string UnfinishedSplat(const std::filesystem::path& workspace);

/// Warns of such a point cloud.
void WarnOfUnfinished(const std::filesystem::path& workspace, const Listener& listener);

}  // namespace oraclegs
