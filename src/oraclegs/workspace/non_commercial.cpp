#include "oraclegs/workspace/non_commercial.h"

#include <algorithm>
#include <set>

#include "oraclegs/workspace/stage_records.h"

namespace oraclegs {
namespace {

constexpr const char* kKey = "non_commercial";
constexpr std::string_view kComment = "not for commercial use: made with ";

}  // namespace

void NoteNonCommercial(const std::string& network, nlohmann::json* record) {
  nlohmann::json& list = (*record)[kKey];
  if (!list.is_array()) list = nlohmann::json::array();
  if (std::find(list.begin(), list.end(), network) == list.end()) list.push_back(network);
}

void NoteNetwork(const VggtWeights& weights, nlohmann::json* record) {
  if (!weights.commercial) NoteNonCommercial(weights.name, record);
}

std::vector<std::string> NonCommercialParts(const WorkspacePaths& workspace) {
  std::set<std::string> parts;
  const nlohmann::json records = ReadStageRecords(workspace.root());
  for (const auto& record : records) {
    if (!record.is_object() || !record.contains(kKey) || !record[kKey].is_array()) continue;
    for (const auto& part : record[kKey]) {
      if (part.is_string()) parts.insert(part.get<std::string>());
    }
  }
  return {parts.begin(), parts.end()};
}

std::vector<std::string> LicenseComments(const std::vector<std::string>& parts) {
  std::vector<std::string> comments;
  for (const std::string& part : parts) comments.push_back(std::string(kComment) + part);
  return comments;
}

std::vector<std::string> PartsInComments(const std::vector<std::string>& comments) {
  std::vector<std::string> parts;
  for (const std::string& comment : comments) {
    if (comment.starts_with(kComment)) parts.push_back(comment.substr(kComment.size()));
  }
  return parts;
}

}  // namespace oraclegs
