#include "oraclegs/sfm/mapper_attempts.h"

#include <fmt/format.h>

#include <map>
#include <system_error>
#include <utility>

#include "oraclegs/core/error.h"
#include "oraclegs/core/system_reason.h"
#include "oraclegs/scene/read_colmap.h"
#include "oraclegs/sfm/colmap_database.h"
#include "oraclegs/sfm/colmap_runner.h"
#include "oraclegs/sfm/colmap_workspace.h"
#include "oraclegs/sfm/retry_schedule.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

/// A model with the database that its keypoints are of, and how these were found.
struct Candidate {
  fs::path model, database;
  ModelQuality quality;
  FeatureSet set;
};

void Rename(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::rename(from, to, error);
  if (error) throw RunError("{}: cannot be renamed: {}", from.string(), SystemReason(error));
}

void Copy(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::copy_file(from, to, fs::copy_options::overwrite_existing, error);
  if (error) throw RunError("{}: cannot be copied to {}: {}", from.string(), to.string(), SystemReason(error));
}

/// All that the attempts write lies in AttemptsFolder(work_dir), a database for each set of features.
class AttemptRunner {
 public:
  AttemptRunner(const AttemptRequest& request, const Listener& listener)
      : request_(request), listener_(listener), folder_(AttemptsFolder(request.work_dir)) {}

  AttemptResult Run() {
    MakeFolder(folder_);
    const std::vector<FeatureSet>& schedule = RegistrationSchedule();
    for (size_t i = 0; i < schedule.size(); ++i) {
      const FeatureSet& set = schedule[i];
      if (i > 0) {
        if (!IsWorthTrying(set, best_.quality, images())) continue;
        listener_(Note{fmt::format("{}; trying again with {}", Registered(), set.name)});
      }
      try {
        Try(set, Colmap(fmt::format("features{}", i)), i == 0);
      } catch (const ColmapFailure&) {
        if (i == 0) throw;  // later sets are optional
      }
    }
    // Last, because what it lets in is less certain than what other features find.
    try {
      Rematch();
    } catch (const ColmapFailure&) {
      // The model that was found before is kept.
    }
    Keep();
    return {best_.quality, std::move(records_)};
  }

 private:
  int images() const { return static_cast<int>(request_.names.size()); }

  ColmapRunner Colmap(const std::string& database) const {
    return ColmapRunner(request_.work_dir, listener_, "register", (folder_.filename() / (database + ".db")).string());
  }

  std::string Registered() const {
    return fmt::format("{} of {} photos are registered", IsSound(best_.quality) ? best_.quality.registered() : 0,
                       images());
  }

  /// The first set is matched in any case: its matches say why images are missing.
  void Try(const FeatureSet& set, const ColmapRunner& colmap, bool is_first) {
    colmap.ExtractFeatures("SIMPLE_RADIAL", request_.has_masks, set.extraction);
    SetFocalPriors(colmap.database(), request_.focal_priors);
    if (is_first) first_database_ = colmap.database();
    if (!is_first && !CanMatch(colmap)) return;
    colmap.MatchExhaustively(set.matching);
    for (const MapperAttempt& attempt : set.attempts) {
      if (IsEnough(best_.quality, images())) break;
      Map(set, attempt, colmap);
    }
    RegisterRemaining(set, colmap);
  }

  /// False when what is missing has too few features for any matching.
  bool CanMatch(const ColmapRunner& colmap) const {
    const auto counts = ReadFeatureCounts(colmap.database());
    std::map<std::string, int> by_name;
    for (const auto& [name, image] : ReadDatabaseImages(colmap.database())) {
      const auto count = counts.find(image.image_id);
      by_name[name] = count == counts.end() ? 0 : count->second;
    }
    return CanMatchMissing(by_name, best_.quality);
  }

  fs::path NewModelFolder() {
    fs::path dir = folder_ / fmt::format("models{}", num_folders_++);
    MakeFolder(dir);
    return dir;
  }

  /// Records one model, and takes it when it is better.
  void Consider(const Candidate& candidate, AttemptRecord* record) {
    if (candidate.quality.registered() > record->registered) {
      record->registered = candidate.quality.registered();
      record->points = candidate.quality.points;
      record->reprojection_error = candidate.quality.reprojection_error;
      record->parallax_degrees = candidate.quality.parallax_degrees;
    }
    if (!IsSound(candidate.quality) || !IsBetter(candidate.quality, best_.quality)) return;
    best_ = candidate;
    for (AttemptRecord& other : records_) other.kept = false;
    record->kept = true;
  }

  void Map(const FeatureSet& set, const MapperAttempt& attempt, const ColmapRunner& colmap) {
    const fs::path models = NewModelFolder();
    ColmapOptions options = attempt.options;
    options["image_path"] = colmap.images().string();
    options["output_path"] = models.string();
    AttemptRecord record{set.name, attempt.name};
    try {
      if (attempt.focal_guess > 0) {
        const ColmapRunner guess = Colmap("focal_guess");
        Copy(colmap.database(), guess.database());
        if (SetFocalGuess(guess.database(), attempt.focal_guess) == 0) return;  // every focal length is known
        guess.Run("mapper", options, "registering, " + attempt.name);
      } else {
        colmap.Run("mapper", options, "registering, " + attempt.name);
      }
    } catch (const ColmapFailure&) {
      // It also ends with an error when it finds no pair to start from.
    }
    for (int i = 0; IsColmapModel(models / std::to_string(i)); ++i) {
      const fs::path model = models / std::to_string(i);
      try {
        Consider({model, colmap.database(), MeasureModel(model), set}, &record);
      } catch (const InputError&) {
        // A mapper that was killed while it wrote leaves half a model; the others are used.
      }
    }
    records_.push_back(std::move(record));
  }

  /// Registers into the best model what is missing, when that model is of this database's keypoints.
  void RegisterRemaining(const FeatureSet& set, const ColmapRunner& colmap) {
    if (!IsSound(best_.quality) || best_.quality.registered() >= images()) return;
    if (best_.database != colmap.database()) return;
    AttemptRecord record{set.name, "remaining images"};
    const fs::path registered = NewModelFolder(), triangulated = NewModelFolder(), adjusted = NewModelFolder();
    ColmapOptions options = RemainingImagesOptions();
    options["input_path"] = best_.model.string();
    options["output_path"] = registered.string();
    try {
      colmap.Run("image_registrator", options, "registering the remaining photos");
      if (!IsColmapModel(registered) ||
          ReadColmapImages(registered).size() <= static_cast<size_t>(best_.quality.registered())) {
        return;
      }
      options["image_path"] = colmap.images().string();
      options["input_path"] = registered.string();
      options["output_path"] = triangulated.string();
      colmap.Run("point_triangulator", options, "triangulating");
      colmap.AdjustBundle(triangulated, adjusted);
      Consider({adjusted, colmap.database(), MeasureModel(adjusted), set}, &record);
    } catch (const ColmapFailure&) {
      // The model that was found before is kept.
    }
    records_.push_back(std::move(record));
  }

  /// With known intrinsics, verification asks for one motion of that camera, so weaker matches can be let in.
  void Rematch() {
    if (IsEnough(best_.quality, images()) || !IsSound(best_.quality)) return;
    const ColmapRunner colmap = Colmap(best_.database.stem().string());
    if (!CanMatch(colmap)) return;
    const auto pairs = PairsOfMissing(request_.names, best_.quality);
    if (pairs.empty()) return;
    const ColmapRunner rematched = Colmap(best_.database.stem().string() + "_rematched");
    Copy(colmap.database(), rematched.database());
    const auto stored = ReadDatabaseImages(rematched.database());
    SetDatabaseCameras(rematched.database(), ReadColmapCameras(best_.model));
    std::vector<std::pair<uint32_t, uint32_t>> ids;
    for (const auto& [a, b] : pairs) {
      if (stored.count(a) > 0 && stored.count(b) > 0) ids.emplace_back(stored.at(a).image_id, stored.at(b).image_id);
    }
    RemoveMatches(rematched.database(), ids);
    rematched.MatchPairs(pairs, RematchOptions());
    FeatureSet set = best_.set;
    set.name += ", matched again";
    best_.database = rematched.database();  // the keypoints are the same
    RegisterRemaining(set, rematched);
    for (const MapperAttempt& attempt : set.attempts) {
      if (attempt.focal_guess > 0 || IsEnough(best_.quality, images())) continue;
      Map(set, attempt, rematched);
    }
  }

  /// Moves the best model to its place and removes the rest.
  void Keep() {
    if (!IsSound(best_.quality)) best_ = {};
    if (!best_.model.empty()) MoveFolder(best_.model, request_.work_dir / "sparse" / "0");
    Rename(best_.database.empty() ? first_database_ : best_.database, request_.work_dir / "database.db");
    RemoveAttempts(request_.work_dir);
  }

  const AttemptRequest& request_;
  const Listener& listener_;
  const fs::path folder_;
  fs::path first_database_;
  Candidate best_;
  std::vector<AttemptRecord> records_;
  int num_folders_ = 0;
};

}  // namespace

AttemptResult RunAttempts(const AttemptRequest& request, const Listener& listener) {
  return AttemptRunner(request, listener).Run();
}

}  // namespace oraclegs
