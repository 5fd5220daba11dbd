#include "oraclegs/sfm/mapper_attempts.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <system_error>
#include <utility>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/scene/read_colmap.h"
#include "oraclegs/sfm/best_model.h"
#include "oraclegs/sfm/choose_pairs.h"
#include "oraclegs/sfm/colmap_database.h"
#include "oraclegs/sfm/colmap_runner.h"
#include "oraclegs/sfm/colmap_workspace.h"
#include "oraclegs/sfm/database_file.h"
#include "oraclegs/sfm/pair_evidence.h"
#include "oraclegs/sfm/retry_schedule.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr int kFacesOfSphere = 2;  // place it

/// A step of the journal: costly features added no photo to a model, and the search is over.
constexpr char kAddsNothing[] = "costly features add nothing";

/// All that the attempts write lies in AttemptsFolder(work_dir), a database for each set of features.
class AttemptRunner {
 public:
  AttemptRunner(const AttemptRequest& request, const Listener& listener)
      : request_(request), listener_(listener), folder_(AttemptsFolder(request.work_dir)), best_(folder_) {}

  AttemptResult Run() {
    MakeFolder(folder_);
    best_.Resume();
    const std::vector<FeatureSet>& schedule = RegistrationSchedule(images());
    first_database_ = Colmap(0).database();
    for (size_t i = 0; i < schedule.size(); ++i) {
      if (schedule[i].is_learned && !request_.find_features) continue;
      if (i > 0 && (HasEnough() || !IsWorthTrying(schedule[i], best_.quality(), images(), Evidence()))) continue;
      TrySet(schedule[i], i);
      if (IsDone(kAddsNothing)) break;
    }
    // Last, because what it lets in is less certain than what other features find.
    try {
      if (!IsDone(kAddsNothing)) Rematch();
    } catch (const ColmapFailure&) {
      // The model that was found before is kept.
    }
    if (!IsSound(best_.quality()) && !crash_.empty()) {
      throw RunError(
          "{}; run the same command again, which repeats only what crashed; if that does not help, install another "
          "version of colmap; see {}",
          crash_, (request_.work_dir / "colmap.log").string());
    }
    LeaveOutMisplaced();
    Keep();
    if (!IsSound(best_.quality())) return {{}, journal().records};
    return {best_.quality(), journal().records, best_.candidate().left_out};
  }

 private:
  AttemptJournal& journal() { return best_.journal(); }
  const AttemptJournal& journal() const { return best_.journal(); }

  int images() const { return static_cast<int>(request_.names.size()); }

  ColmapRunner Colmap(const std::string& database, const std::string& label = "") const {
    return {request_.work_dir, listener_, "register", (folder_.filename() / (database + ".db")).string(), label};
  }

  ColmapRunner Colmap(size_t set) const {
    const std::vector<FeatureSet>& schedule = RegistrationSchedule(images());
    const auto fits = [&](const FeatureSet& s) {
      return images() <= s.max_images && (request_.find_features || !s.is_learned);
    };
    const auto most = std::count_if(schedule.begin(), schedule.end(), fits);
    const auto number = std::count_if(schedule.begin(), schedule.begin() + static_cast<std::ptrdiff_t>(set) + 1, fits);
    return Colmap(fmt::format("features{}", set),
                  set == 0 ? "" : fmt::format("attempt {} of at most {}, {}: ", number, most, schedule[set].name));
  }

  /// Two faces place a sphere, of which others may show plain sky.
  bool HasEnough() const {
    if (IsEnough(best_.quality(), images())) return true;
    if (request_.spheres.empty() || !IsSound(best_.quality())) return false;
    std::map<std::string, int> faces;
    for (const auto& [image, sphere] : request_.spheres) faces[sphere] += best_.quality().images.count(image);
    const bool all_placed =
        std::all_of(faces.begin(), faces.end(), [](const auto& f) { return f.second >= kFacesOfSphere; });
    return all_placed && std::all_of(request_.names.begin(), request_.names.end(), [&](const std::string& name) {
             return request_.spheres.count(name) > 0 || best_.quality().images.count(name) > 0;
           });
  }

  bool IsDone(const std::string& step) const { return journal().steps.count(step) > 0; }

  void MarkStep(const std::string& step) {
    journal().steps.insert(step);
    WriteAttemptJournal(journal(), folder_);
  }

  /// A crash says nothing of the photos: what was begun is no finished step, and the next call makes it again.
  void NoteCrash(const ColmapFailure& failure) {
    if (!failure.IsCrash()) return;
    ++crashes_;
    crash_ = failure.Text();
  }

  void TrySet(const FeatureSet& set, size_t number) {
    if (IsDone(set.name)) {
      Gather(Colmap(number).database());
      return;
    }
    if (number > 0) {
      listener_(Note{
          fmt::format("{} of {} photos are registered; trying again with {}", best_.registered(), images(), set.name)});
    }
    const int crashes = crashes_, before = best_.registered();
    try {
      Try(set, Colmap(number), number == 0);
    } catch (const ColmapFailure& failure) {
      if (number == 0) throw;  // later sets are optional
      NoteCrash(failure);
    }
    if (crashes_ != crashes) return;
    MarkStep(set.name);
    const bool is_costly = set.needs_link && images() > kMaxImagesForAllFeatures;
    if (is_costly && before > 0 && best_.registered() <= before) MarkStep(kAddsNothing);
  }

  /// The first set is matched in any case: its matches say why images are missing.
  void Try(const FeatureSet& set, const ColmapRunner& colmap, bool is_first) {
    if (set.is_learned) {
      Learn(set, colmap);
    } else if (!IsDone(set.name + ", extracted")) {
      RemoveDatabase(colmap.database());  // what a stopped extraction left has no whole cameras
      colmap.ExtractFeatures("SIMPLE_RADIAL", request_.has_masks, set.extraction);
      SetFocalPriors(colmap.database(), request_.focal_priors);
      MarkStep(set.name + ", extracted");
    }
    if (!is_first && !CanMatch(colmap)) return;
    if (!IsDone(set.name + ", matched")) {
      MatchImages(colmap, set.matching, listener_);  // pairs that are matched already are passed over
      MarkStep(set.name + ", matched");
    }
    Gather(colmap.database());
    for (const MapperAttempt& attempt : set.attempts) {
      if (HasEnough() || !has_pairs_) break;
      const std::string step = set.name + ", " + attempt.name;
      if (IsDone(step)) continue;
      const int crashes = crashes_;
      Map(set, attempt, colmap);
      if (crashes_ == crashes) MarkStep(step);
    }
    RegisterRemaining(set, colmap);
  }

  /// Adds a network's features and matches to those of the first set.
  void Learn(const FeatureSet& set, const ColmapRunner& colmap) {
    if (IsDone(set.name + ", matched")) return;
    RemoveDatabase(colmap.database());  // what a stopped run left has some of them
    CopyDatabase(first_database_, colmap.database());
    AddLearnedFeatures(colmap, request_.find_features, listener_);
    MarkStep(set.name + ", matched");
  }

  /// Adds what a database says of its images to what the ones before said.
  void Gather(const fs::path& database) {
    std::error_code ignored;
    has_pairs_ = false;
    if (!fs::exists(database, ignored)) return;
    const std::vector<PairEvidence> pairs = ReadPairEvidence(database, request_.work_dir / "images");
    has_pairs_ = !pairs.empty();
    for (const PairEvidence& pair : pairs) {
      if (pair.IsLink()) links_.insert({pair.first, pair.second});
    }
    one_place_ = AreFromOnePoint(pairs);
  }

  MatchEvidence Evidence() const { return EvidenceOf(links_, best_.quality(), one_place_); }

  /// False when what is missing has too few features for any matching.
  bool CanMatch(const ColmapRunner& colmap) const {
    const auto counts = ReadFeatureCounts(colmap.database());
    std::map<std::string, int> by_name;
    for (const auto& [name, image] : ReadDatabaseImages(colmap.database())) {
      const auto count = counts.find(image.image_id);
      by_name[name] = count == counts.end() ? 0 : count->second;
    }
    return CanMatchMissing(by_name, best_.quality());
  }

  /// Leaves out photos that stand at a wrong place, which COLMAP's thresholds alone do not show; then those that only
  /// agreed with them.
  void LeaveOutMisplaced() {
    while (LeaveOutSomeMisplaced()) {
    }
  }

  bool LeaveOutSomeMisplaced() {
    if (!request_.confirmed_shares || !IsSound(best_.quality()) || best_.registered() > kMaxImagesForRetries) {
      return false;
    }
    if (!HasLooseView(best_.quality())) return false;  // the check takes a second a photo
    const Scene model = ReadColmapScene(best_.candidate().model, request_.work_dir / "images", Silent());
    listener_(StepDone{"register", best_.registered(), 0, "images", "checking places by depth"});
    const std::vector<double> shares = request_.confirmed_shares(model);
    std::vector<std::string> misplaced;
    for (const size_t view : MisplacedViews(shares)) misplaced.push_back(model.views[view].name);
    if (misplaced.empty() || best_.registered() < static_cast<int>(misplaced.size()) + 2) return false;
    AttemptRecord record{best_.candidate().set.name, "without misplaced photos"};
    try {
      best_.LeaveOut(misplaced, Colmap(0), &record);
    } catch (const ColmapFailure&) {
      // They stay.
    }
    journal().records.push_back(record);
    return record.kept;
  }

  /// The mapper refines the intrinsics of all cameras or of none.
  void FixKnownCameras(ColmapOptions* options) const {
    if (!request_.known_cameras) return;
    (*options)["Mapper.ba_refine_focal_length"] = "0";
    (*options)["Mapper.ba_refine_extra_params"] = "0";
  }

  void Map(const FeatureSet& set, const MapperAttempt& attempt, const ColmapRunner& colmap) {
    const fs::path models = best_.NewModelFolder();
    ColmapOptions options = attempt.options;
    FixKnownCameras(&options);
    options["image_path"] = colmap.images().string();
    options["output_path"] = models.string();
    AttemptRecord record{set.name, attempt.name};
    try {
      if (attempt.focal_guess > 0) {
        const ColmapRunner guess = Colmap("focal_guess", colmap.label());
        CopyDatabase(colmap.database(), guess.database());
        if (SetFocalGuess(guess.database(), attempt.focal_guess) == 0) return;  // every focal length is known
        guess.Run("mapper", options, "registering, " + attempt.name);
      } else {
        colmap.Run("mapper", options, "registering, " + attempt.name);
      }
    } catch (const ColmapFailure& failure) {
      NoteCrash(failure);  // else it ended with an error, as when it finds no pair to start from
    }
    for (int i = 0; IsColmapModel(models / std::to_string(i)); ++i) {
      const fs::path model = models / std::to_string(i);
      try {
        best_.Consider({model, colmap.database(), MeasureModel(model), set}, colmap, &record);
      } catch (const InputError&) {
        // A mapper that was killed while it wrote leaves half a model; the others are used.
      } catch (const ColmapFailure&) {
        // The model cannot be had without its implausible cameras.
      }
    }
    journal().records.push_back(std::move(record));
  }

  /// Registers into the best model what is missing, when that model is of this database's keypoints.
  void RegisterRemaining(const FeatureSet& set, const ColmapRunner& colmap) {
    if (!IsSound(best_.quality()) || best_.registered() >= images()) return;
    if (best_.candidate().database != colmap.database()) return;
    AttemptRecord record{set.name, "remaining images"};
    const fs::path registered = best_.NewModelFolder(), triangulated = best_.NewModelFolder(),
                   adjusted = best_.NewModelFolder();
    ColmapOptions options = RemainingImagesOptions();
    FixKnownCameras(&options);
    options["input_path"] = best_.candidate().model.string();
    options["output_path"] = registered.string();
    try {
      colmap.Run("image_registrator", options, "registering the remaining photos");
      if (!IsColmapModel(registered) ||
          ReadColmapImages(registered).size() <= static_cast<size_t>(best_.registered())) {
        return;
      }
      options["image_path"] = colmap.images().string();
      options["input_path"] = registered.string();
      options["output_path"] = triangulated.string();
      colmap.Run("point_triangulator", options, "triangulating");
      colmap.AdjustBundle(triangulated, adjusted);
      best_.Consider({adjusted, colmap.database(), MeasureModel(adjusted), set}, colmap, &record);
    } catch (const ColmapFailure&) {
      // The model that was found before is kept.
    }
    journal().records.push_back(std::move(record));
  }

  /// With known intrinsics, verification asks for one motion of that camera, so weaker matches can be let in.
  void Rematch() {
    if (HasEnough() || !IsSound(best_.quality())) return;
    if (best_.candidate().set.is_learned) return;  // colmap cannot match a network's features
    const ColmapRunner colmap = Colmap(best_.candidate().database.stem().string());
    if (!CanMatch(colmap) || !LinksMakeAModel(Evidence(), images())) return;
    const auto pairs = PairsOfMissing(request_.names, best_.quality());
    if (pairs.empty()) return;
    const ColmapRunner rematched = Colmap(best_.candidate().database.stem().string() + "_rematched");
    CopyDatabase(colmap.database(), rematched.database());
    const auto stored = ReadDatabaseImages(rematched.database());
    SetDatabaseCameras(rematched.database(), ReadColmapCameras(best_.candidate().model));
    std::vector<std::pair<uint32_t, uint32_t>> ids;
    for (const auto& [a, b] : pairs) {
      if (stored.count(a) > 0 && stored.count(b) > 0) ids.emplace_back(stored.at(a).image_id, stored.at(b).image_id);
    }
    RemoveMatches(rematched.database(), ids);
    rematched.MatchPairs(pairs, RematchOptions(), "matching again");
    FeatureSet set = best_.candidate().set;
    set.name += ", matched again";
    best_.SetDatabase(rematched.database());  // the keypoints are the same
    RegisterRemaining(set, rematched);
    for (const MapperAttempt& attempt : set.attempts) {
      if (attempt.focal_guess > 0 || HasEnough()) continue;
      Map(set, attempt, rematched);
    }
  }

  /// Moves the best model to its place and removes the rest.
  void Keep() {
    const Candidate& best = best_.candidate();
    const bool is_sound = IsSound(best.quality);
    if (is_sound) MoveTo(best.model, request_.work_dir / "sparse" / "0");
    MoveTo(is_sound ? best.database : first_database_, request_.work_dir / "database.db");
    RemoveAttempts(request_.work_dir);
  }

  const AttemptRequest& request_;
  const Listener& listener_;
  const fs::path folder_;
  fs::path first_database_;
  BestModel best_;
  int crashes_ = 0;
  std::string crash_;                           ///< the last one
  ImageLinks links_;                            ///< links found by any set of features
  bool has_pairs_ = false, one_place_ = false;  ///< by the set that was tried last
};

}  // namespace

AttemptResult RunAttempts(const AttemptRequest& request, const Listener& listener) {
  return AttemptRunner(request, listener).Run();
}

}  // namespace oraclegs
