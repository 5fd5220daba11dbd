#include "oraclegs/sfm/mapper_attempts.h"

#include <fmt/format.h>

#include <optional>
#include <system_error>

#include "oraclegs/core/error.h"
#include "oraclegs/sfm/colmap_database.h"
#include "oraclegs/sfm/colmap_runner.h"
#include "oraclegs/sfm/retry_schedule.h"
#include "oraclegs/sfm/colmap_workspace.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

/// A model with the database that its keypoints are of, and how these were found.
struct Candidate {
  fs::path model, database;
  ModelQuality quality;
  FeatureSet set;
};

class Climb {
 public:
  Climb(const AttemptRequest& request, const Listener& listener) : request_(request), listener_(listener) {}

  AttemptResult Run() {
    int number = 0;
    for (const FeatureSet& set : RegistrationLadder()) {
      const bool first = number == 0;
      const std::string database = first ? "database.db" : fmt::format("database{}.db", number);
      ++number;
      if (!first && !IsWorthTrying(set, best_.quality, photographs())) continue;
      if (!first) {
        listener_(Note{fmt::format("{}; trying again with {}", Registered(), set.name)});
      }
      try {
        Try(set, ColmapRunner(request_.work_dir, listener_, database));
      } catch (const ColmapFailure&) {
        if (first) throw;  // later ones are only a chance that is lost
      }
    }
    // Last, because what it lets in is less certain than what other features find.
    try {
      MatchAgain();
    } catch (const ColmapFailure&) {
      // The model that stood before still stands.
    }
    Keep();
    return {best_.quality, std::move(attempts_)};
  }

 private:
  int photographs() const { return static_cast<int>(request_.names.size()); }

  std::string Registered() const {
    return fmt::format("{} of {} photographs are registered", IsSound(best_.quality) ? best_.quality.registered() : 0,
                       photographs());
  }

  void Try(const FeatureSet& set, const ColmapRunner& colmap) {
    colmap.ExtractFeatures("SIMPLE_RADIAL", request_.has_masks, set.extraction);
    // The first set's matches tell why photographs are missing, so they are made in any case.
    if (colmap.database().filename() != "database.db" && !CanMatch(colmap)) return;
    colmap.MatchExhaustively(set.matching);
    for (const MapperTry& attempt : set.tries) {
      if (IsEnough(best_.quality, photographs())) break;
      Map(set, attempt, colmap);
    }
    RegisterLeftOver(set, colmap);
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

  fs::path NewFolder() {
    const fs::path dir = request_.work_dir / "models" / std::to_string(folders_++);
    MakeFolder(dir);
    return dir;
  }

  /// Notes one model, and takes it when it is better.
  void Consider(const Candidate& candidate, AttemptRecord* record) {
    if (candidate.quality.registered() > record->registered) {
      record->registered = candidate.quality.registered();
      record->points = candidate.quality.points;
      record->reprojection_error = candidate.quality.reprojection_error;
      record->parallax_degrees = candidate.quality.parallax_degrees;
    }
    if (!IsSound(candidate.quality) || !IsBetter(candidate.quality, best_.quality)) return;
    best_ = candidate;
    for (AttemptRecord& other : attempts_) other.kept = false;
    record->kept = true;
  }

  void Map(const FeatureSet& set, const MapperTry& attempt, const ColmapRunner& colmap) {
    const fs::path models = NewFolder();
    ColmapOptions options = attempt.options;
    options["image_path"] = colmap.images().string();
    options["output_path"] = models.string();
    AttemptRecord record{set.name, attempt.name};
    try {
      if (attempt.focal_guess > 0) {
        const ColmapRunner guess(request_.work_dir, listener_, "guess.db");
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
        // A mapper that was killed while it wrote leaves half a model; the others count.
      }
    }
    attempts_.push_back(std::move(record));
  }

  /// Registers into the best model what is missing, when that model is of this database's keypoints.
  void RegisterLeftOver(const FeatureSet& set, const ColmapRunner& colmap) {
    if (!IsSound(best_.quality) || best_.quality.registered() >= photographs()) return;
    if (best_.database != colmap.database()) return;
    AttemptRecord record{set.name, "left over"};
    const fs::path registered = NewFolder(), triangulated = NewFolder(), adjusted = NewFolder();
    ColmapOptions options = LeftOverOptions();
    options["input_path"] = best_.model.string();
    options["output_path"] = registered.string();
    try {
      colmap.Run("image_registrator", options, "registering what is left over");
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
      // The model that stood before still stands.
    }
    attempts_.push_back(std::move(record));
  }

  /// With the lens known, verification asks for one motion of that lens, so weaker matches can be let in.
  void MatchAgain() {
    if (IsEnough(best_.quality, photographs()) || !IsSound(best_.quality)) return;
    const ColmapRunner colmap(request_.work_dir, listener_, best_.database.filename().string());
    if (!CanMatch(colmap)) return;
    const auto pairs = PairsOfMissing(request_.names, best_.quality);
    if (pairs.empty()) return;
    const ColmapRunner again(request_.work_dir, listener_, colmap.database().stem().string() + "_again.db");
    Copy(colmap.database(), again.database());
    const auto images = ReadDatabaseImages(again.database());
    SetDatabaseCameras(again.database(), ReadColmapCameras(best_.model));
    std::vector<std::pair<uint32_t, uint32_t>> ids;
    for (const auto& [a, b] : pairs) {
      if (images.count(a) > 0 && images.count(b) > 0) ids.emplace_back(images.at(a).image_id, images.at(b).image_id);
    }
    ForgetMatches(again.database(), ids);
    again.MatchPairs(pairs, MatchAgainOptions());
    FeatureSet matched_again = best_.set;
    matched_again.name += ", matched again";
    best_.database = again.database();  // the keypoints are the same
    RegisterLeftOver(matched_again, again);
    for (const MapperTry& attempt : matched_again.tries) {
      if (attempt.focal_guess > 0 || IsEnough(best_.quality, photographs())) continue;
      Map(matched_again, attempt, again);
    }
  }

  static void Copy(const fs::path& from, const fs::path& to) {
    std::error_code error;
    fs::copy_file(from, to, fs::copy_options::overwrite_existing, error);
    if (error) throw RunError("{}: cannot be copied to {}: {}", from.string(), to.string(), error.message());
  }

  /// Moves the best model to its place and clears the rest away.
  void Keep() {
    std::error_code error;
    const fs::path final_database = request_.work_dir / "database.db";
    if (IsSound(best_.quality)) {
      MoveFolder(best_.model, request_.work_dir / "sparse" / "0");
      if (best_.database != final_database) fs::rename(best_.database, final_database, error);
      if (error) throw RunError("{}: cannot be renamed: {}", best_.database.string(), error.message());
    } else {
      best_ = {};
    }
    RemoveIntermediate(request_.work_dir);
  }

  const AttemptRequest& request_;
  const Listener& listener_;
  Candidate best_;
  std::vector<AttemptRecord> attempts_;
  int folders_ = 0;
};

}  // namespace

AttemptResult FindModel(const AttemptRequest& request, const Listener& listener) {
  return Climb(request, listener).Run();
}

}  // namespace oraclegs
