#include "oraclegs/pipeline/settings/options.h"

#include <nlohmann/json.hpp>

namespace oraclegs {

nlohmann::json ShapingOptionsToJson(const RunOptions& options) {
  nlohmann::json json = nlohmann::json::object();
  RunOptions::ForEachShapingGroup(options, [&](const char*, const auto& group) { json.update(OptionsToJson(group)); });
  return json;
}

nlohmann::json RunOptionsToJson(const RunOptions& options) {
  nlohmann::json json = nlohmann::json::object();
  RunOptions::ForEachGroup(options, [&](const char*, const auto& group) { json.update(OptionsToJson(group)); });
  return json;
}

void CheckRunOptions(const RunOptions& options) {
  RunOptions::ForEachGroup(options, [](const char*, const auto& group) { CheckOptions(group); });
}

}  // namespace oraclegs
