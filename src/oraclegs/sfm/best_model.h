#pragma once
// The best model that attempts have found so far, and the journal that says which it is.

#include <filesystem>
#include <string>
#include <vector>

#include "oraclegs/sfm/attempt_journal.h"
#include "oraclegs/sfm/colmap_quality.h"
#include "oraclegs/sfm/colmap_runner.h"
#include "oraclegs/sfm/retry_schedule.h"

namespace oraclegs {

/// A model with the database that its keypoints are of, and how these were found.
struct Candidate {
  std::filesystem::path model, database;
  ModelQuality quality;
  FeatureSet set;
  std::vector<std::string> left_out = {};  ///< images that had no camera in it that can be right
};

/// Keeps the best of all candidates. Models lie below `folder`, where the journal is.
class BestModel {
 public:
  explicit BestModel(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Takes up what an earlier call has finished.
  void Resume();

  const Candidate& candidate() const { return best_; }
  const ModelQuality& quality() const { return best_.quality; }
  AttemptJournal& journal() { return journal_; }
  const AttemptJournal& journal() const { return journal_; }
  /// Images of a sound model, 0 without one.
  int registered() const { return IsSound(best_.quality) ? best_.quality.registered() : 0; }

  std::filesystem::path NewModelFolder();

  /// Notes a candidate in `record`, and takes it when it is better, without the few cameras of it that are implausible.
  /// Throws ColmapFailure.
  void Consider(const Candidate& candidate, const ColmapRunner& colmap, AttemptRecord* record);

  /// Takes the best model without these images, if that is sound. Throws ColmapFailure.
  void LeaveOut(const std::vector<std::string>& names, const ColmapRunner& colmap, AttemptRecord* record);

  /// The best model's keypoints are in this database, too.
  void SetDatabase(std::filesystem::path database) { best_.database = std::move(database); }

 private:
  void Take(const Candidate& candidate, AttemptRecord* record);

  std::filesystem::path folder_;
  Candidate best_;
  AttemptJournal journal_;
};

}  // namespace oraclegs
