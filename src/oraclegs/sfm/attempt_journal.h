#pragma once
// Steps that are finished of the attempts to find cameras, written after each one: a run that was stopped or killed
// goes on there.

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <set>
#include <string>
#include <vector>

namespace oraclegs {

/// Result of one run of the mapper, or of the registration of the remaining images.
struct AttemptRecord {
  std::string features, name;
  int registered = 0, points = 0;
  double reprojection_error = 0;  ///< pixels
  double parallax_degrees = 0;
  bool kept = false;      ///< at most one is
  std::string flaw = {};  ///< why its model cannot be right; "" = it can, or there is none
};

struct AttemptJournal {
  std::set<std::string> steps;  ///< that are finished, by names of the caller's
  std::vector<AttemptRecord> records;
  std::string model, database, features;  ///< folder, file and set of features of the best model; empty without one
  std::vector<std::string> left_out;      ///< images that were left out of the best model for their camera
  int folders = 0;                        ///< folders of models that were made
};

nlohmann::json RecordToJson(const AttemptRecord& record);

/// The journal of that folder of attempts; an empty one where there is none, or a damaged one.
AttemptJournal ReadAttemptJournal(const std::filesystem::path& folder);
/// Throws RunError.
void WriteAttemptJournal(const AttemptJournal& journal, const std::filesystem::path& folder);

}  // namespace oraclegs
