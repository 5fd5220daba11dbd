#include "oraclegs/sfm/attempt_journal.h"

#include <nlohmann/json.hpp>

#include "oraclegs/core/files.h"
#include "oraclegs/core/unique_json.h"

namespace oraclegs {
namespace {

constexpr char kJournal[] = "journal.json";

AttemptRecord RecordFromJson(const nlohmann::json& json) {
  AttemptRecord record;
  json.at("features").get_to(record.features);
  json.at("name").get_to(record.name);
  json.at("registered").get_to(record.registered);
  json.at("points").get_to(record.points);
  json.at("reprojection_error").get_to(record.reprojection_error);
  json.at("parallax_degrees").get_to(record.parallax_degrees);
  json.at("kept").get_to(record.kept);
  json.at("flaw").get_to(record.flaw);
  return record;
}

}  // namespace

nlohmann::json RecordToJson(const AttemptRecord& record) {
  return {{"features", record.features},
          {"name", record.name},
          {"registered", record.registered},
          {"points", record.points},
          {"reprojection_error", record.reprojection_error},
          {"parallax_degrees", record.parallax_degrees},
          {"kept", record.kept},
          {"flaw", record.flaw}};
}

AttemptJournal ReadAttemptJournal(const std::filesystem::path& folder) {
  std::error_code ignored;
  if (!std::filesystem::exists(folder / kJournal, ignored)) return {};
  try {
    const nlohmann::json json = ParseJson(ReadFile(folder / kJournal));
    AttemptJournal journal;
    json.at("steps").get_to(journal.steps);
    for (const nlohmann::json& record : json.at("records")) journal.records.push_back(RecordFromJson(record));
    json.at("model").get_to(journal.model);
    json.at("database").get_to(journal.database);
    json.at("features").get_to(journal.features);
    json.at("left_out").get_to(journal.left_out);
    json.at("folders").get_to(journal.folders);
    return journal;
  } catch (const std::exception&) {
    return {};  // all is made again
  }
}

void WriteAttemptJournal(const AttemptJournal& journal, const std::filesystem::path& folder) {
  nlohmann::json records = nlohmann::json::array();
  for (const AttemptRecord& record : journal.records) records.push_back(RecordToJson(record));
  const nlohmann::json json{{"steps", journal.steps},       {"records", std::move(records)},
                            {"model", journal.model},       {"database", journal.database},
                            {"features", journal.features}, {"left_out", journal.left_out},
                            {"folders", journal.folders}};
  WriteFileAtomically(folder / kJournal, json.dump(1) + "\n");
}

}  // namespace oraclegs
