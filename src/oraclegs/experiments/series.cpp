#include "oraclegs/experiments/series.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <variant>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/unique_json.h"

namespace oraclegs {

void RequireSeriesFolder(const std::filesystem::path& out, const SeriesFiles& files) {
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(out, ignored)) {
    const std::string name = entry.path().filename().string();
    if (std::find(files.names.begin(), files.names.end(), name) != files.names.end()) continue;
    if (name.rfind(".oraclegs-", 0) == 0) continue;
    throw InputError("{}: is not empty and holds no {} of oraclegs; choose a new or empty folder with -o", out.string(),
                     files.what);
  }
  if (!std::filesystem::exists(out / files.report, ignored)) return;
  const nlohmann::json saved = ParseJsonOrDiscard(ReadFile(out / files.report));
  if (saved.is_object() && saved.value("program", nlohmann::json()) == "oraclegs") return;
  throw InputError("{}: was not written by oraclegs; choose a new or empty folder with -o",
                   (out / files.report).string());
}

Listener SeriesListener::ForRun(const std::string& where) {
  const bool first = first_;
  first_ = false;
  return [this, where, first](const Event& event) {
    if (const auto* stage = std::get_if<StageStarted>(&event)) {
      listener_(StageStarted{where + stage->stage});
    } else if (const auto* step = std::get_if<StepDone>(&event)) {
      listener_(StepDone{where + step->stage, step->done, step->total, step->unit, step->detail});
    } else if (const auto* end = std::get_if<StageFinished>(&event)) {
      listener_(StageFinished{where + end->stage, end->seconds});
    } else if (const auto* warning = std::get_if<Warning>(&event)) {
      if (warned_.insert(warning->text).second) listener_(*warning);
    } else if (std::holds_alternative<Note>(event) && first) {
      listener_(event);
    }
  };
}

}  // namespace oraclegs
