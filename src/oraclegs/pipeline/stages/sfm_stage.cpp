#include "oraclegs/pipeline/stages/sfm_stage.h"

#include "oraclegs/sfm/pose_check.h"
#include "oraclegs/sfm/triangulate.h"

namespace oraclegs {
namespace {

bool IsWanted(const Run& run) { return run.options.start.init != StartKind::kRandom || run.plan.needs_depth; }

void AddSfmKey(Run* run, Fingerprint* key) {
  key->Add(ViewsFingerprint(run->scene, run->split.train, 1, &run->files));
  for (const ScenePoint& p : run->scene.points) key->Add(p.xyz.x()).Add(p.xyz.y()).Add(p.xyz.z());
}

std::vector<ScenePoint> PointsOfTrainingViews(const Run& run) {
  std::vector<ScenePoint> points = PointsSeenBy(run.scene, run.split.train);
  if (points.size() >= kMinSparseStart) return points;
  if (!run.scene.points.empty()) {
    run.listener(Note{fmt::format("{} of the model's {} points were seen by two training views; triangulating anew",
                                  points.size(), run.scene.points.size())});
  }
  // For images without poses sfm/ itself holds the registration.
  const auto dir = run.photos.empty() ? run.workspace.sfm() : run.workspace.sfm() / "training_views";
  std::vector<ScenePoint> triangulated = TriangulatePoints(run.scene, run.split.train, dir, run.listener);
  return triangulated.size() > points.size() ? triangulated : points;
}

/// Colmap's files are a cache of their own, which checks its inputs.
bool LoadSfm(Run* run) {
  for (const std::string& warning : PoseWarnings(run->scene, run->split.train)) run->listener(Warning{warning});
  run->results->points = PointsOfTrainingViews(*run);
  return true;
}

std::optional<nlohmann::json> MakeSfm(Run* run, const std::string&) {
  LoadSfm(run);
  return nlohmann::json{{"points", run->results->points.size()}, {"files", nlohmann::json::array()}};
}

}  // namespace

StageWork SfmStage() { return {.wanted = IsWanted, .own = AddSfmKey, .make = MakeSfm, .load = LoadSfm}; }

}  // namespace oraclegs
