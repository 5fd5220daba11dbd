#include "oraclegs/workspace/saved_run.h"

#include <algorithm>

#include "oraclegs/core/files.h"
#include "oraclegs/core/unique_json.h"
#include "oraclegs/settings/named_options.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kMaxJsonBytes = 64 << 20;

fs::path OptionsFile(const fs::path& dir) { return dir / "options.json"; }

std::string Shown(const nlohmann::json& value) {
  return value.is_string() ? (value.get<std::string>().empty() ? "not given" : value.get<std::string>()) : value.dump();
}

}  // namespace

nlohmann::json ReadRunJson(const fs::path& path) {
  try {
    return ParseJson(ReadFile(path, kMaxJsonBytes));
  } catch (const nlohmann::json::exception&) {
    throw InputError("{}: is damaged, it is not valid JSON", path.string());
  }
}

bool IsWorkspace(const fs::path& dir) {
  std::error_code ignored;
  return fs::is_regular_file(OptionsFile(dir), ignored);
}

SavedRun ReadSavedRun(const fs::path& dir) {
  const fs::path path = OptionsFile(dir);
  nlohmann::json json;
  try {
    json = ReadRunJson(path);
  } catch (const InputError& damage) {
    throw InputError("{}; choose another -o, or delete the folder", damage.what());
  }
  const bool ours = json.is_object() && json.value("program", nlohmann::json()) == "oraclegs" &&
                    json.contains("scene") && json["scene"].is_string() && json.contains("options") &&
                    json["options"].is_object();
  if (!ours) throw InputError("{}: was not written by oraclegs; choose another folder", path.string());
  if (json.value("format", nlohmann::json()) != kRunFormat) {
    throw InputError("{}: is of format {}, this program reads {}; choose another -o", path.string(),
                     json.value("format", nlohmann::json()).dump(), kRunFormat);
  }
  const nlohmann::json start = json.value("start_iterations", nlohmann::json());
  SavedRun saved{json["scene"].get<std::string>(),
                 {},
                 json["options"],
                 json.value("size", nlohmann::json()),
                 start.is_number_integer() ? std::max<int64_t>(0, start.get<int64_t>()) : 0};
  const nlohmann::json inputs = json.value("inputs", nlohmann::json::array());
  for (const nlohmann::json& input : inputs) {
    if (input.is_string()) saved.inputs.push_back(input.get<std::string>());
  }
  std::error_code ignored;
  // The folder may have been moved since.
  if (!saved.inputs.empty()) saved.scene = fs::weakly_canonical(fs::absolute(dir, ignored), ignored) / "photos";
  return saved;
}

std::string DescribeDifference(const nlohmann::json& saved, const RunOptions& now, const nlohmann::json& size) {
  const nlohmann::json current = ShapingOptionsToJson(now), defaults = ShapingOptionsToJson(RunOptions{});
  std::string text;
  for (const auto& [name, value] : current.items()) {
    const nlohmann::json& before = saved.contains(name) ? saved.at(name) : defaults.at(name);
    if (before == value) continue;
    if (before == "auto" && size.is_object() && size.contains(name) && size.at(name) == value) continue;
    text += fmt::format("{}{} was {}, now is {}", text.empty() ? "" : "; ", RunOptionShown(name), Shown(before),
                        Shown(value));
  }
  return text;
}

std::string QualityOf(const SavedRun& saved) {
  const nlohmann::json word = saved.options.value("quality", nlohmann::json());
  return word.is_string() ? word.get<std::string>() : Word(QualityOptions().quality);
}

bool AsksForHigherQuality(const SavedRun& saved, const RunOptions& now) {
  for (const auto& [quality, word] : EnumWords<Quality>::kWords) {
    if (word != QualityOf(saved) || now.quality.quality <= quality) continue;
    nlohmann::json others = saved.options;
    others["quality"] = Word(now.quality.quality);
    return DescribeDifference(others, now, saved.size).empty();
  }
  return false;
}

int64_t IterationsOf(const SavedRun& saved) {
  for (const nlohmann::json* from : {&saved.options, &saved.size}) {
    const nlohmann::json value = from->is_object() ? from->value("iterations", nlohmann::json()) : nlohmann::json();
    if (value.is_number_integer()) return value.get<int64_t>();
  }
  return 0;
}

bool AsksForMoreIterations(const SavedRun& saved, const RunOptions& now) {
  const int64_t before = IterationsOf(saved);
  if (before == 0 || now.train.iterations.is_auto() || now.train.iterations.value() <= before) return false;
  nlohmann::json others = saved.options;
  others["iterations"] = now.train.iterations.value();
  return DescribeDifference(others, now, saved.size).empty();
}

}  // namespace oraclegs
