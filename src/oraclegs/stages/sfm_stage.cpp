#include "oraclegs/stages/stage_works.h"

#include "oraclegs/core/error.h"
#include "oraclegs/core/text.h"
#include "oraclegs/settings/from_results.h"
#include "oraclegs/sfm/pose_check.h"
#include "oraclegs/sfm/pose_fit.h"
#include "oraclegs/sfm/register_views.h"
#include "oraclegs/stages/stage_seconds.h"

namespace oraclegs {
namespace {

bool IsWanted(const Run& run) {
  const Auto<StartKind>& init = run.options.start.init;
  return (init != StartKind::kRandom && init != StartKind::kRandomCube) || run.plan.needs_depth;
}

/// Whether the scene's own points serve. Where views are held out, or lack their images, they do not: those views
/// helped to place them.
bool TakesModel(const Run& run) {
  const bool all_train = run.split.train.size() == run.Given().views.size() && run.Given().missing_images.empty();
  return SettleSfmPoints(run.options.start, all_train) == SfmPoints::kModel && !run.Given().points.empty();
}

void AddSfmKey(Run* run, Fingerprint* key) {
  key->Add(ViewsKey(run, run->split.train, ImageOptions()));
  if (!TakesModel(*run)) return;
  for (const ScenePoint& p : run->Given().points) key->Add(p.xyz.x()).Add(p.xyz.y()).Add(p.xyz.z());
}

/// Sparse points, and where colmap left matches between the training photos.
struct FoundPoints {
  std::vector<ScenePoint> points;
  std::filesystem::path matches;
};

FoundPoints PointsOfTrainingViews(const Run& run) {
  std::vector<ScenePoint> points;
  if (TakesModel(run)) {
    points = PointsSeenBy(run.Given(), run.split.train);
    if (points.size() >= kMinSparseStart) return {std::move(points), run.workspace.sfm() / "pose_check"};
    run.listener(Note{fmt::format("{} of the model's {} points were seen by two training views; triangulating anew",
                                  points.size(), run.Given().points.size())});
  }
  // For images without poses sfm/ itself holds the registration.
  TriangulationFolders folders{run.workspace.sfm()};
  if (!run.photos.empty()) folders = {run.workspace.sfm() / "training_views", run.workspace.sfm()};
  std::vector<ScenePoint> triangulated = TriangulatePoints(run.Given(), run.split.train, folders, run.listener);
  return {triangulated.size() > points.size() ? std::move(triangulated) : std::move(points), folders.work};
}

/// Holds poses that came with the scene against the matches between its photos. Throws InputError for hopeless ones.
nlohmann::json CheckGivenPoses(const Run& run, const std::filesystem::path& matches) {
  if (!run.photos.empty()) return nullptr;  // colmap found them out of these very matches
  // A model's points came with its poses and fit them: only the photos can tell.
  if (matches != run.workspace.sfm()) MatchForCheck(run.Given(), run.split.train, matches, run.listener);
  const Eigen::Vector3d origin = RunFromScene(run.frame) * Eigen::Vector3d(0, 0, 0);
  const std::optional<PoseFit> fit = FitPosesOf(run.Given(), run.split.train, origin, matches, run.listener);
  if (!fit) return nullptr;
  const std::string misfit = DescribeMisfit(run.Given(), *fit);
  if (fit->verdict == PoseVerdict::kHopeless && !run.options.frame.force) {
    throw InputError("{}: {}; --force trains with them as they are", run.Given().root.string(), misfit);
  }
  if (!misfit.empty()) {
    run.listener(Warning{misfit + (run.plan.refines_poses ? "; what can be corrected is corrected before depth" : "")});
  }
  nlohmann::json record = ToJson(*fit);
  record["warning"] = misfit;
  return record;
}

/// Colmap's files are a cache of their own, which checks its inputs. Returns what the check of the poses found.
nlohmann::json FindPoints(Run* run) {
  for (const std::string& warning : PoseWarnings(run->Given(), run->split.train)) run->listener(Warning{warning});
  FoundPoints found = PointsOfTrainingViews(*run);
  run->results->points = std::move(found.points);
  return CheckGivenPoses(*run, found.matches);
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

double SecondsOfSfm(const EstimateInput& input) {
  constexpr double kTriangulation = 0.5, kReuse = 0.3;
  const bool found = input.photos > 0 && input.test_views + input.other_views == 0;  // all by registration
  if (found) return kReuse;
  return kTriangulation + (input.photos > 0 ? 0 : SecondsOfFeatures(input, input.scene.views));
}

}  // namespace

StageWork SfmStage() {
  return {.wanted = IsWanted,
          .own = AddSfmKey,
          .make = MakeSfm,
          .load = LoadSfm,
          .summary = [](const nlohmann::json& r) { return Counted(CountIn(r, "points"), "point"); },
          .seconds = SecondsOfSfm};
}

}  // namespace oraclegs
