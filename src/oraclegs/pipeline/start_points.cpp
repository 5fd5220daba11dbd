#include "oraclegs/pipeline/start_points.h"

#include <algorithm>
#include <utility>

#include "oraclegs/pipeline/fingerprint.h"
#include "oraclegs/scene/sfm.h"

namespace oraclegs {
namespace {

constexpr size_t kFewestPoints = 4;  // a point needs three neighbours to have a scale

std::string Key(const Run& run) {
  Fingerprint print;
  print.Add(run.options.start.init).Add(ViewsFingerprint(run.scene, run.split.train));
  for (const ScenePoint& p : run.scene.points) print.Add(p.xyz.x()).Add(p.xyz.y()).Add(p.xyz.z());
  return print.Hex();
}

std::vector<ScenePoint> PointsOfTrainingViews(const Run& run) {
  std::vector<ScenePoint> points = PointsSeenBy(run.scene, run.split.train);
  if (points.size() >= kEnoughPoints) return points;
  if (!run.scene.points.empty()) {
    run.listener(Note{fmt::format("{} of the model's {} points were seen by two training views; triangulating anew",
                                  points.size(), run.scene.points.size())});
  }
  // For a plain folder of photographs sfm/ itself holds the registration.
  const bool registered = !run.workspace.Record("register").is_null();
  const auto dir = registered ? run.workspace.sfm() / "training_views" : run.workspace.sfm();
  std::vector<ScenePoint> triangulated = TriangulatePoints(run.scene, run.split.train, dir, run.listener);
  return triangulated.size() > points.size() ? triangulated : points;
}

/// As many as asked for, within the budget that `taken` points leave.
PointCloud RandomPoints(const Run& run, size_t taken = 0) {
  const int n = std::min(run.options.train.random_points, run.options.train.max_gaussians - static_cast<int>(taken));
  if (run.scene.format == SceneFormat::kBlender) return RandomPointsInBlenderCube(n, run.options.start.seed);
  std::vector<Camera> cameras;
  for (const int view : run.split.train) {
    cameras.push_back(WorkingCamera(run.scene.views[static_cast<size_t>(view)], run.options.photo));
  }
  return RandomPointsInView(cameras, n, run.options.start.seed);
}

StartPoints FindStartPoints(const Run& run) {
  if (run.options.start.init == "random") return {RandomPoints(run), "random"};
  std::vector<ScenePoint> points = PointsOfTrainingViews(run);
  const bool fixed = run.options.start.init == "sfm";
  if (fixed && points.size() < kFewestPoints) {
    throw InputError("{}: the training views gave {} points, too few to start from; use --init random",
                     run.scene.root.string(), points.size());
  }
  if (!fixed && points.size() < kEnoughPoints) {
    run.listener(
        Warning{fmt::format("the training views gave {} points, fewer than {}: starting from random points, "
                            "which reconstructs fine detail less well",
                            points.size(), kEnoughPoints)});
    return {RandomPoints(run), "random"};
  }
  const auto limit = static_cast<size_t>(run.options.train.max_gaussians);
  if (points.size() > limit) {
    run.listener(Note{fmt::format("starting from {} of {} points (--max-gaussians)", limit, points.size())});
    for (size_t i = 0; i < limit; ++i) points[i] = points[i * points.size() / limit];
    points.resize(limit);
  }
  PointCloud cloud = ToPointCloud(points);
  if (fixed || points.size() >= std::min(kPlentyOfPoints, limit)) return {std::move(cloud), "sfm"};
  const PointCloud more = RandomPoints(run, points.size());
  cloud.xyz.insert(cloud.xyz.end(), more.xyz.begin(), more.xyz.end());
  cloud.rgb.insert(cloud.rgb.end(), more.rgb.begin(), more.rgb.end());
  return {std::move(cloud), "sfm+random"};
}

}  // namespace

StartPoints RunSfm(Run* run) {
  const std::string key = Key(*run);
  const nlohmann::json before = run->workspace.Record("sfm");
  const bool done = run->workspace.IsDone("sfm", key);
  const StageClock clock("sfm", run->listener);
  StartPoints start = FindStartPoints(*run);
  const double seconds = clock.Finish();
  run->listener(Note{fmt::format("starting from {} points ({})", start.cloud.xyz.size(), start.source)});
  run->workspace.MarkDone("sfm", {{"key", key},
                                  {"seconds", done ? before.value("seconds", seconds) : seconds},
                                  {"source", start.source},
                                  {"points", start.cloud.xyz.size()},
                                  {"files", nlohmann::json::array()}});
  return start;
}

}  // namespace oraclegs
