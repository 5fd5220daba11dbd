#include "oraclegs/sfm/register_views.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/text.h"
#include "oraclegs/core/unique_json.h"
#include "oraclegs/scene/read_colmap.h"
#include "oraclegs/sfm/colmap_database.h"
#include "oraclegs/sfm/colmap_runner.h"
#include "oraclegs/sfm/colmap_staging.h"
#include "oraclegs/sfm/colmap_workspace.h"
#include "oraclegs/sfm/mapper_attempts.h"
#include "oraclegs/sfm/pair_evidence.h"
#include "oraclegs/sfm/pose_doubts.h"
#include "oraclegs/sfm/registration_report.h"
#include "oraclegs/sfm/tie_spheres.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr char kReport[] = "registration.json";

/// The photos that take part, and those that are copies of one of them.
struct Distinct {
  std::vector<int> views;      ///< indices into Scene::views
  std::map<int, int> same_as;  ///< a copy's index -> that of the one that takes part
};

Distinct FindDistinct(const Scene& photos, const nlohmann::json& inputs) {
  Distinct distinct;
  std::map<std::string, std::vector<int>> by_sum;
  for (const int v : AllViews(photos)) {
    if (photos.views[v].sphere) {  // its sphere is placed as a whole
      distinct.views.push_back(v);
      continue;
    }
    std::vector<int>& alike = by_sum[inputs.at("images").at(static_cast<size_t>(v)).at("file").dump()];
    for (const int other : alike) {
      if (ReadFile(photos.views[other].image_path) != ReadFile(photos.views[v].image_path)) continue;
      distinct.same_as[v] = other;
      break;
    }
    if (distinct.same_as.count(v) > 0) continue;
    alike.push_back(v);
    distinct.views.push_back(v);
  }
  return distinct;
}

/// Features and matches of each photo, by the database that the kept model was made from.
std::vector<ViewReport> GatherEvidence(const Scene& photos, const Distinct& distinct,
                                       const std::vector<StagedView>& plan, const fs::path& work_dir) {
  std::vector<ViewReport> reports(photos.views.size());
  for (size_t v = 0; v < reports.size(); ++v) reports[v].name = photos.views[v].name;
  for (const auto& [copy, original] : distinct.same_as) reports[copy].same_as = photos.views[original].name;

  std::map<std::string, int> view_of;
  for (size_t i = 0; i < plan.size(); ++i) view_of[plan[i].name] = distinct.views[i];
  const fs::path database = work_dir / "database.db";
  const std::map<uint32_t, int> features = ReadFeatureCounts(database);
  for (const auto& [name, image] : ReadDatabaseImages(database)) {
    const auto found = features.find(image.image_id);
    if (view_of.count(name) > 0 && found != features.end()) reports[view_of[name]].features = found->second;
  }
  for (const PairEvidence& pair : ReadPairEvidence(database, work_dir / "images")) {
    const auto a = view_of.find(pair.first), b = view_of.find(pair.second);
    if (a == view_of.end() || b == view_of.end()) continue;
    ViewReport &first = reports[a->second], &second = reports[b->second];
    first.neighbors.push_back({second.name, pair.inliers, pair.pure_rotation});
    second.neighbors.push_back({first.name, pair.inliers, pair.pure_rotation});
  }
  return reports;
}

/// Doubts about the model in work_dir, by names of views.
std::vector<std::string> GatherDoubts(const Scene& photos, const Distinct& distinct,
                                      const std::vector<StagedView>& plan, const fs::path& work_dir) {
  std::map<std::string, const SceneView*> view_of;
  for (size_t i = 0; i < plan.size(); ++i) {
    view_of[plan[i].name] = &photos.views[static_cast<size_t>(distinct.views[i])];
  }
  const fs::path model = work_dir / "sparse" / "0";
  const ColmapCameras cameras = ReadColmapCameras(model);
  std::map<uint32_t, FocalLength> focals;
  for (const ColmapImage& image : ReadColmapImages(model)) {
    const SceneView& view = *view_of.at(image.name);
    FocalLength& focal = focals[image.camera_id];
    focal.photos.push_back(view.name);
    focal.found = cameras.at(image.camera_id).fx();
    focal.by_exif = std::max(focal.by_exif, view.focal_prior);
  }
  std::vector<PairMotions> pairs = ReadPairMotions(work_dir / "database.db", work_dir / "images");
  std::erase_if(pairs, [&](const PairMotions& pair) {
    return view_of.count(pair.first) == 0 || view_of.count(pair.second) == 0;
  });
  for (PairMotions& pair : pairs) {
    pair.first = view_of[pair.first]->name;
    pair.second = view_of[pair.second]->name;
  }
  std::vector<FocalLength> known;
  for (auto& [id, focal] : focals) known.push_back(std::move(focal));
  return PoseDoubts(pairs, known);
}

[[noreturn]] void FailRegistration(const Scene& photos, const RegistrationReport& report, const fs::path& work_dir) {
  const std::string see = (work_dir / kReport).string();
  if (TakenFromOnePoint(report)) {
    throw InputError(
        "{}: its {} photos were taken from one point (they differ by a pure rotation of the camera), so depth cannot "
        "be found; move sideways between photos instead of only turning the camera; see {}",
        photos.root.string(), photos.views.size(), see);
  }
  throw InputError(
      "{}: the cameras of its {} photos could not be found: {}. Take them again with more overlap between "
      "neighbors and sharp, textured surfaces, or give poses (transforms.json or a COLMAP model); see {}",
      photos.root.string(), photos.views.size(), WhyMissing(report), see);
}

/// `request`: names and focal lengths are still to be filled in.
RegistrationReport Register(const Scene& photos, const Distinct& distinct, const std::vector<StagedView>& plan,
                            AttemptRequest request, const Listener& listener) {
  const fs::path& work_dir = request.work_dir;
  for (size_t i = 0; i < plan.size(); ++i) {
    request.names.push_back(plan[i].name);
    const double focal = photos.views[distinct.views[i]].focal_prior;
    if (focal > 0) request.focal_priors[plan[i].name] = focal;
    if (photos.views[distinct.views[i]].sphere) {
      request.spheres[plan[i].name] = photos.views[distinct.views[i]].sphere->name;
    }
  }
  request.known_cameras = request.spheres.size() == plan.size();
  AttemptResult result;
  try {
    request.has_masks = StageImages(photos, distinct.views, plan, work_dir);
    result = RunAttempts(request, listener);
    if (IsSound(result.best) && TieSpheres(photos, distinct.views, plan, work_dir, listener)) {
      result.best = MeasureModel(work_dir / "sparse" / "0");
    }
  } catch (const ColmapFailure& failure) {
    throw RunError("{}; see {}", failure.Text(), (work_dir / "colmap.log").string());
  }
  std::map<std::string, RegisteredImage> by_view_name;
  for (size_t i = 0; i < plan.size(); ++i) {
    const std::string& name = photos.views[distinct.views[i]].name;
    const auto found = result.best.images.find(plan[i].name);
    if (found != result.best.images.end()) by_view_name[name] = found->second;
    std::replace(result.left_out.begin(), result.left_out.end(), plan[i].name, name);
  }
  result.best.images = std::move(by_view_name);
  RegistrationReport report = MakeReport(GatherEvidence(photos, distinct, plan, work_dir), result);
  for (size_t v = 0; v < report.views.size(); ++v) {  // plain sky needs no other photo of it
    ViewReport& view = report.views[v];
    if (photos.views[v].sphere && view.status == ViewStatus::kRegistered) view.advice.clear();
  }
  if (report.registered() >= 2) {
    for (std::string& doubt : GatherDoubts(photos, distinct, plan, work_dir)) {
      report.warnings.push_back(std::move(doubt));
    }
  }
  WriteFileAtomically(work_dir / kReport, ReportToJson(report).dump(1) + "\n");
  // Colmap now and then makes a model of a pure rotation, out of the matches' noise.
  if (report.registered() < 2 || TakenFromOnePoint(report)) FailRegistration(photos, report, work_dir);
  return report;
}

/// The warnings of the run that made a cached result, to be reported again.
std::vector<std::string> StoredWarnings(const fs::path& work_dir) {
  try {
    return ParseJson(ReadFile(work_dir / kReport)).at("warnings").get<std::vector<std::string>>();
  } catch (const std::exception&) {
    return {};  // written by a version without warnings, or damaged: the model alone is used
  }
}

void RequireColmap(const Scene& photos) {
  if (ColmapAvailable()) return;
  throw InputError(
      "{}: has photos without poses, and the colmap program that finds them is not installed; install it "
      "(Debian: apt install colmap) or give a scene with poses",
      photos.root.string());
}

}  // namespace

Scene RegisterViews(const Scene& photos, const fs::path& work_dir, const Listener& listener,
                    const FeatureFinder& find_features, const ConfirmedShares& confirmed_shares) {
  const nlohmann::json inputs = DescribeInputs(photos, AllViews(photos));
  const Distinct distinct = FindDistinct(photos, inputs);
  if (distinct.views.size() < 2 && photos.views.size() >= 2) {
    throw InputError("{}: its {} photos are one and the same; take photos from different places", photos.root.string(),
                     photos.views.size());
  }
  const std::vector<StagedView> plan = PlanStaging(photos, distinct.views, Upright::kTurn);
  std::vector<std::string> warnings;
  if (IsUnchanged(work_dir, inputs)) {
    RestoreImages(photos, distinct.views, plan, work_dir);
    warnings = StoredWarnings(work_dir);
  } else {
    RequireColmap(photos);
    nlohmann::json tried = inputs;
    if (find_features) tried["learned_features"] = true;  // with them it may not fail
    if (const std::string failed = RememberedFailure(work_dir, tried); !failed.empty()) {
      listener(Note{"all attempts were made by an earlier call, with the same photos; --overwrite makes them again"});
      throw InputError("{}", failed);
    }
    BeginAttempts(work_dir, inputs);
    try {
      AttemptRequest request;
      request.work_dir = work_dir;
      request.find_features = find_features;
      request.confirmed_shares = confirmed_shares;
      warnings = Register(photos, distinct, plan, std::move(request), listener).warnings;
    } catch (const InputError& failure) {
      RememberFailure(work_dir, tried, failure.what());
      throw;
    }
    MarkDone(work_dir, inputs);
  }
  ModelInScene model = ReadModel(photos, distinct.views, plan, work_dir, listener);
  for (const std::string& warning : warnings) listener(Warning{warning});
  const bool doubtful = std::any_of(warnings.begin(), warnings.end(),
                                    [](const std::string& warning) { return warning.starts_with(kPosesDoubtful); });
  if (model.views.size() == photos.views.size()) {
    listener(Note{fmt::format("registered {} of {}{}", model.views.size(), Counted(photos.views.size(), "photo"),
                              doubtful ? ", but the poses are doubtful: see the warning" : "")});
  }
  return RegisteredScene(photos, std::move(model));
}

}  // namespace oraclegs
