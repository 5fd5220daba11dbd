#include "oraclegs/app/project.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/text.h"
#include "oraclegs/core/unique_json.h"

namespace oraclegs {
namespace {

constexpr double kMinScale = 1e-6, kMaxScale = 1e6;
constexpr size_t kMaxNameCharacters = 80;
constexpr uint64_t kMaxRecordBytes = 1 << 16;

bool IsBox(const std::string& text) {
  if (!text.starts_with("box:")) return false;
  const std::vector<std::string> numbers = SplitTrimmed(text.substr(4), ',');
  if (numbers.size() != 6 || std::count(text.begin(), text.end(), ',') != 5) return false;
  return std::all_of(numbers.begin(), numbers.end(), [](const std::string& number) {
    char* end = nullptr;
    return std::isfinite(std::strtod(number.c_str(), &end)) && *end == '\0';
  });
}

bool IsAxis(const std::string& text) {
  static constexpr std::array kAxes = {"auto", "x", "-x", "y", "-y", "z", "-z"};
  return std::find(kAxes.begin(), kAxes.end(), text) != kAxes.end();
}

void TakeShare(const nlohmann::json& json, const char* key, double* to) {
  const nlohmann::json value = json.value(key, nlohmann::json(*to));
  if (!value.is_number() || !(value.get<double>() >= 0 && value.get<double>() <= 1)) {
    throw InputError("{}: must be a number from 0 to 1", key);
  }
  *to = value.get<double>();
}

}  // namespace

nlohmann::json EditsToJson(const ExportEdits& edits) {
  return {{"crop", edits.crop},
          {"up", edits.up},
          {"scale", edits.scale > 0 ? nlohmann::json(edits.scale) : nlohmann::json("auto")},
          {"min_support", edits.min_support},
          {"max_uncertainty", edits.max_uncertainty},
          {"remove_outliers", edits.remove_outliers}};
}

ExportEdits EditsFromJson(const nlohmann::json& json, ExportEdits edits) {
  if (!json.is_object()) throw InputError("the edits must be an object");
  const auto text = [&](const char* key, std::string* to) {
    const nlohmann::json value = json.value(key, nlohmann::json(*to));
    if (!value.is_string()) throw InputError("{}: must be a text", key);
    *to = value.get<std::string>();
  };
  text("crop", &edits.crop);
  if (edits.crop != "none" && edits.crop != "auto" && !IsBox(edits.crop)) {
    throw InputError("crop: must be none, auto or six numbers as box:x0,y0,z0,x1,y1,z1");
  }
  text("up", &edits.up);
  if (!IsAxis(edits.up)) throw InputError("up: must be auto, x, -x, y, -y, z or -z");
  const nlohmann::json scale = json.value("scale", EditsToJson(edits).at("scale"));
  const bool fits = scale.is_number() && scale.get<double>() >= kMinScale && scale.get<double>() <= kMaxScale;
  if (scale != "auto" && !fits) throw InputError("scale: must be auto, or a number from 0.000001 to 1000000");
  edits.scale = fits ? scale.get<double>() : 0;
  TakeShare(json, "min_support", &edits.min_support);
  TakeShare(json, "max_uncertainty", &edits.max_uncertainty);
  const nlohmann::json outliers = json.value("remove_outliers", nlohmann::json(edits.remove_outliers));
  if (!outliers.is_boolean()) throw InputError("remove_outliers: must be true or false");
  edits.remove_outliers = outliers.get<bool>();
  return edits;
}

std::vector<std::string> EditArguments(const ExportEdits& edits) {
  std::vector<std::string> words;
  const auto add = [&](const char* flag, const std::string& value) { words.insert(words.end(), {flag, value}); };
  if (edits.crop != "none") add("--crop", edits.crop);
  if (edits.up != "auto") words.push_back("--up=" + edits.up);  // one word: "-y" is no flag
  if (edits.scale > 0) add("--scale", fmt::format("{}", edits.scale));
  if (edits.min_support > 0) add("--min-support", fmt::format("{}", edits.min_support));
  if (edits.max_uncertainty < 1) add("--max-uncertainty", fmt::format("{}", edits.max_uncertainty));
  if (edits.remove_outliers) words.emplace_back("--remove-outliers");
  return words;
}

ProjectRecord ReadProjectRecord(const ProjectPaths& paths) {
  ProjectRecord record;
  record.name = OneLine(paths.root().filename().string());
  nlohmann::json json;
  try {
    json = ParseJsonOrDiscard(ReadFile(paths.record(), kMaxRecordBytes));
  } catch (const InputError&) {  // it was damaged or removed by somebody
    return record;
  }
  if (!json.is_object()) return record;
  const auto text = [&](const char* key, std::string* to) {
    if (json.contains(key) && json[key].is_string()) *to = json[key].get<std::string>();
  };
  text("name", &record.name);
  text("quality", &record.quality);
  text("device", &record.device);
  if (json.contains("queued") && json["queued"].is_number_integer()) record.queued = json["queued"].get<int64_t>();
  record.started = json.value("started", nlohmann::json()) == true;
  record.process = ProcessMarkFromJson(json.value("process", nlohmann::json()));
  try {
    record.edits = EditsFromJson(json.value("edits", nlohmann::json::object()), {});
  } catch (const InputError&) {  // edited by hand: an export without edits says no less than the splat
  }
  return record;
}

void WriteProjectRecord(const ProjectPaths& paths, const ProjectRecord& record) {
  const nlohmann::json json = {{"name", record.name},
                               {"quality", record.quality},
                               {"device", record.device},
                               {"queued", record.queued},
                               {"started", record.started},
                               {"process", ProcessMarkToJson(record.process)},
                               {"edits", EditsToJson(record.edits)}};
  WriteFileAtomically(paths.record(), json.dump(2) + "\n");
}

std::string CleanName(const std::string& typed) {
  if (!IsUtf8(typed)) throw InputError("the name is not UTF-8");
  std::string name;
  size_t characters = 0;
  for (const char c : OneLine(typed)) {
    const bool begins = (static_cast<unsigned char>(c) & 0xc0) != 0x80;
    if (begins && ++characters > kMaxNameCharacters) break;
    name += c;
  }
  const size_t first = name.find_first_not_of(' '), last = name.find_last_not_of(' ');
  if (first == std::string::npos) throw InputError("the name is empty; give it one");
  return name.substr(first, last - first + 1);
}

}  // namespace oraclegs
