#include "oraclegs/workspace/advice.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/unique_json.h"
#include "oraclegs/sfm/pose_doubts.h"
#include "oraclegs/workspace/workspace.h"

namespace oraclegs {
namespace {

using nlohmann::json;

constexpr uint64_t kMaxBytes = 256 << 20;

json ReadOrNull(const std::filesystem::path& path) {
  try {
    return ParseJsonOrDiscard(ReadFile(path, kMaxBytes));
  } catch (const Error&) {
    return nullptr;
  }
}

std::string TextAt(const json& object, const char* key) {
  const auto found = object.is_object() ? object.find(key) : object.end();
  return object.is_object() && found != object.end() && found->is_string() ? found->get<std::string>() : "";
}

json ListAt(const json& object, const char* key) {
  if (!object.is_object() || !object.contains(key) || !object[key].is_array()) return json::array();
  return object[key];
}

}  // namespace

std::vector<std::string> PhotoAdvice(const std::filesystem::path& workspace, size_t most) {
  const WorkspacePaths paths(workspace);
  std::vector<std::string> advice;
  for (const json& view : ListAt(ReadOrNull(paths.sfm() / "registration.json"), "views")) {
    if (const std::string text = TextAt(view, "advice"); !text.empty()) {
      advice.push_back(fmt::format("{}: {}", TextAt(view, "name"), text));
    }
  }
  const json document = ReadOrNull(paths.report() / "run.json");
  if (document.is_object() && document.contains("registration")) {
    for (const json& place : ListAt(document["registration"], "advice")) {
      if (const std::string text = TextAt(place, "text"); !text.empty()) advice.push_back(text);
    }
  }
  if (advice.size() > most) advice.resize(most);
  return advice;
}

std::vector<std::string> StoredPoseDoubts(const std::filesystem::path& workspace) {
  std::vector<std::string> doubts;
  for (const json& warning : ListAt(ReadOrNull(WorkspacePaths(workspace).sfm() / "registration.json"), "warnings")) {
    if (!warning.is_string()) continue;
    if (const auto text = warning.get<std::string>(); text.starts_with(kPosesDoubtful)) doubts.push_back(text);
  }
  return doubts;
}

}  // namespace oraclegs
