#include "oraclegs/stages/stage_table.h"

#include "oraclegs/core/text.h"

namespace oraclegs {

using nlohmann::json;

std::string StageTable(const std::vector<Stage>& stages, const json& before, const json& after) {
  std::vector<std::vector<std::string>> lines = {{"stage", "time", "predicted", "result"}};
  double total = 0, kept = 0, predicted_total = 0;
  bool any_predicted = false, all_predicted = true;
  for (const Stage& stage : stages) {
    if (!after.contains(stage.name) || !after[stage.name].is_object()) continue;
    const json& record = after[stage.name];
    const double seconds = record.value("seconds", 0.0), predicted = record.value("predicted_seconds", 0.0);
    const bool unchanged = before.contains(stage.name) && before[stage.name] == record;
    lines.push_back({stage.name, FormatSeconds(seconds), predicted > 0 ? FormatSeconds(predicted) : "",
                     stage.work.summary(record) + (unchanged ? " (unchanged)" : "")});
    total += seconds, predicted_total += predicted;
    kept += unchanged ? seconds : 0;
    any_predicted = any_predicted || predicted > 0;
    all_predicted = all_predicted && predicted > 0;
  }
  lines.push_back({"total", FormatSeconds(total), all_predicted ? FormatSeconds(predicted_total) : "",
                   kept > 0 ? fmt::format("{} in this run", FormatSeconds(total - kept)) : ""});
  if (any_predicted) return AlignColumns(lines, "lrrl");
  for (auto& line : lines) line.erase(line.begin() + 2);
  return AlignColumns(lines, "lrl");
}

}  // namespace oraclegs
