#include "oraclegs/pipeline/stages/sfm_stage.h"

#include "oraclegs/core/error.h"
#include "oraclegs/sfm/pose_check.h"
#include "oraclegs/sfm/pose_fit_words.h"
#include "oraclegs/sfm/triangulate.h"

namespace oraclegs {
namespace {

bool IsWanted(const Run& run) {
  const Auto<StartKind>& init = run.options.start.init;
  return (init != StartKind::kRandom && init != StartKind::kRandomCube) || run.plan.needs_depth;
}

/// Whether the scene's own points serve. Where views are held out, or lack their images, they do not: those views
/// helped to place them.
bool TakesModel(const Run& run) {
  const bool all_train = run.split.train.size() == run.scene.views.size() && run.scene.missing_images.empty();
  const auto asked = run.options.start.sfm_points.ValueOr(all_train ? SfmPoints::kModel : SfmPoints::kTriangulate);
  return asked == SfmPoints::kModel && !run.scene.points.empty();
}

void AddSfmKey(Run* run, Fingerprint* key) {
  key->Add(ViewsFingerprint(run->scene, run->split.train, ImageOptions(), &run->files));
  if (!TakesModel(*run)) return;
  for (const ScenePoint& p : run->scene.points) key->Add(p.xyz.x()).Add(p.xyz.y()).Add(p.xyz.z());
}

std::vector<ScenePoint> PointsOfTrainingViews(const Run& run) {
  std::vector<ScenePoint> points;
  if (TakesModel(run)) {
    points = PointsSeenBy(run.scene, run.split.train);
    if (points.size() >= kMinSparseStart) return points;
    run.listener(Note{fmt::format("{} of the model's {} points were seen by two training views; triangulating anew",
                                  points.size(), run.scene.points.size())});
  }
  // For images without poses sfm/ itself holds the registration.
  const auto dir = run.photos.empty() ? run.workspace.sfm() : run.workspace.sfm() / "training_views";
  std::vector<ScenePoint> triangulated = TriangulatePoints(run.scene, run.split.train, dir, run.listener);
  return triangulated.size() > points.size() ? triangulated : points;
}

/// Holds poses that came with the scene against what was matched to triangulate. Throws InputError for hopeless ones.
nlohmann::json CheckGivenPoses(const Run& run) {
  if (!run.photos.empty()) return nullptr;  // colmap found them out of these very matches
  const std::optional<PoseFit> fit = FitPosesOf(run.scene, run.split.train, run.workspace.sfm(), run.listener);
  if (!fit) return nullptr;
  const std::string misfit = DescribeMisfit(run.scene, *fit);
  if (fit->verdict == PoseVerdict::kHopeless && !run.options.input_checks.force) {
    throw InputError("{}: {}; --force trains with them as they are", run.scene.root.string(), misfit);
  }
  if (!misfit.empty()) run.listener(Warning{misfit});
  nlohmann::json record = ToJson(*fit);
  record["warning"] = misfit;
  return record;
}

/// Colmap's files are a cache of their own, which checks its inputs.
nlohmann::json FindPoints(Run* run) {
  for (const std::string& warning : PoseWarnings(run->scene, run->split.train)) run->listener(Warning{warning});
  run->results->points = PointsOfTrainingViews(*run);
  return TakesModel(*run) ? nullptr : CheckGivenPoses(*run);
}

bool LoadSfm(Run* run) {
  FindPoints(run);
  return true;
}

std::optional<nlohmann::json> MakeSfm(Run* run, const std::string&) {
  nlohmann::json poses = FindPoints(run);
  return nlohmann::json{
      {"points", run->results->points.size()}, {"files", nlohmann::json::array()}, {"poses", std::move(poses)}};
}

}  // namespace

StageWork SfmStage() { return {.wanted = IsWanted, .own = AddSfmKey, .make = MakeSfm, .load = LoadSfm}; }

}  // namespace oraclegs
