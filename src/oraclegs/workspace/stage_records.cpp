#include "oraclegs/workspace/stage_records.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/unique_json.h"

namespace oraclegs {
namespace {

using nlohmann::json;

constexpr uint64_t kMaxRecordBytes = 64 << 20;

bool IsText(const json& value) { return value.is_string(); }
/// True for numbers that are exact as a double and as an integer of 64 bits, of which readers take either.
bool IsNumber(const json& value) {
  constexpr double kMaxNumber = 9007199254740992;  // 2^53
  return value.is_number() && std::abs(value.get<double>()) <= kMaxNumber;
}
bool IsTruth(const json& value) { return value.is_boolean(); }
bool IsList(const json& value) { return value.is_array(); }
bool IsTextList(const json& value) { return value.is_array() && std::all_of(value.begin(), value.end(), IsText); }
bool IsNumberList(const json& value) { return value.is_object() && std::all_of(value.begin(), value.end(), IsNumber); }
bool IsObject(const json& value) { return value.is_object(); }
bool IsObjectOrNull(const json& value) { return value.is_object() || value.is_null(); }

struct Field {
  std::string_view name;
  bool (*is_sound)(const json& value);
};

/// Fields of all records; a record need not have all of them.
constexpr std::array kFields = {Field{"key", IsText},
                                Field{"seconds", IsNumber},
                                Field{"predicted_seconds", IsNumber},
                                Field{"files", IsTextList},
                                Field{"non_commercial", IsList},
                                Field{"photos", IsNumber},
                                Field{"registered", IsNumber},
                                Field{"points", IsNumber},
                                Field{"confident_share", IsNumber},
                                Field{"right", IsNumber},
                                Field{"prior", IsText},
                                Field{"sensor", IsObject},
                                Field{"source", IsText},
                                Field{"models", IsNumber},
                                Field{"targets", IsNumber},
                                Field{"folder", IsNumber},
                                Field{"oracle", IsText},
                                Field{"chunk", IsNumber},
                                Field{"mean_confidence", IsNumberList},
                                Field{"training_seconds", IsNumber},
                                Field{"iterations", IsNumber},
                                Field{"gaussians", IsNumber},
                                Field{"peak_memory_bytes", IsNumber},
                                Field{"chosen", IsObject},
                                Field{"milliseconds_per_iteration", IsObjectOrNull},
                                Field{"test", IsObject},
                                Field{"others", IsTextList},
                                Field{"support", IsObject},
                                Field{"uncertainty", IsObject},
                                Field{"of", IsText},
                                Field{"worth", IsNumber}};

/// Checks the network that found poses; other stages record theirs as text.
bool IsNetwork(const json& value) {
  if (!value.is_object()) return value.is_null() || value.is_string();
  const auto has = [&](const char* name, bool (*is_sound)(const json&)) {
    return !value.contains(name) || is_sound(value[name]);
  };
  return has("name", IsText) && has("fingerprint", IsText) && has("commercial", IsTruth);
}

bool IsSound(const json& record) {
  if (!record.is_object() || (record.contains("network") && !IsNetwork(record["network"]))) return false;
  return std::all_of(kFields.begin(), kFields.end(), [&](const Field& field) {
    const auto found = record.find(field.name);
    return found == record.end() || field.is_sound(*found);
  });
}

}  // namespace

StageRecords InspectStageRecords(const std::filesystem::path& workspace) {
  StageRecords records;
  const std::filesystem::path file = workspace / "stages.json";
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) return records;
  json all;
  try {
    all = ParseJsonOrDiscard(ReadFile(file, kMaxRecordBytes));
  } catch (const InputError&) {
  }
  records.is_readable = all.is_object();
  if (!records.is_readable) return records;
  for (const auto& [stage, record] : all.items()) {
    if (IsSound(record)) {
      records.by_stage[stage] = record;
    } else {
      records.damaged.push_back(stage);
    }
  }
  return records;
}

nlohmann::json ReadStageRecords(const std::filesystem::path& workspace) {
  return InspectStageRecords(workspace).by_stage;
}

std::string UnfinishedSplat(const std::filesystem::path& workspace) {
  const json record = ReadStageRecords(workspace).value(kBestSoFar, json());
  const json of = record.is_object() ? record.value("of", json()) : json();
  return of.is_string() ? of.get<std::string>() : "";
}

void WarnOfUnfinished(const std::filesystem::path& workspace, const Listener& listener) {
  const std::string of = UnfinishedSplat(workspace);
  if (of.empty()) return;
  listener(Warning{fmt::format("{}: its run was stopped: this is its {}; the command that began it goes on",
                               (workspace / "point_cloud.ply").string(), of)});
}

}  // namespace oraclegs
