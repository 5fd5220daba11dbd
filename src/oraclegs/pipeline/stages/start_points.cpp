#include "oraclegs/pipeline/stages/start_points.h"

#include <algorithm>
#include <utility>

#include "oraclegs/depth/plane_fill.h"
#include "oraclegs/depth/prior_points.h"
#include "oraclegs/pipeline/workspace/fingerprint.h"
#include "oraclegs/pipeline/stages/propose_stage.h"
#include "oraclegs/sfm/pose_check.h"
#include "oraclegs/sfm/triangulate.h"

namespace oraclegs {
namespace {

constexpr size_t kFewestPoints = 4;   // a point needs three neighbours to have a scale
constexpr double kRandomShare = 0.1;  // of the budget, in a hybrid start

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

/// The points of one --init word after the other, within the budget.
class StartBuilder {
 public:
  StartBuilder(const Run& run, const std::vector<LoadedView>& photos, const std::vector<ScenePoint>& sfm,
               const Geometry& geometry)
      : run_(run),
        photos_(photos),
        sfm_(sfm),
        geometry_(geometry),
        budget_(static_cast<size_t>(run.options.train.max_gaussians)) {}

  StartPoints Build() {
    const std::string& init = run_.options.start.init;
    if (init == "random") {
      AddRandom(static_cast<size_t>(run_.options.train.random_points));
    } else if (init == "sfm") {
      Require(sfm_.size(), "the training views gave {} points, too few to start from; use --init random");
      AddSfm();
    } else if (init == "dense") {
      Require(geometry_.points.size(), "stereo gave {} points, too few to start from; use --init sfm or --init random");
      AddDense(budget_);
    } else if (init == "hybrid") {
      AddHybrid();
    } else {
      AddBest();
    }
    return std::move(start_);
  }

 private:
  void Require(size_t points, const char* message) const {
    if (points >= kFewestPoints) return;
    throw InputError("{}: {}", run_.scene.root.string(), fmt::format(fmt::runtime(message), points));
  }

  void AddBest() {
    if (geometry_.points.size() >= kPlentyOfPoints) {
      AddDense(budget_);
      return;
    }
    if (NeedsDepth(run_.options)) {
      run_.listener(Warning{fmt::format(
          "stereo gave {} points only: the photographs overlap too little, or their surfaces have no texture; starting "
          "without them",
          geometry_.points.size())});
    }
    if (sfm_.size() < kEnoughPoints) {
      run_.listener(
          Warning{fmt::format("the training views gave {} points, fewer than {}: starting from random points, which "
                              "reconstructs fine detail less well",
                              sfm_.size(), kEnoughPoints)});
      AddRandom(static_cast<size_t>(run_.options.train.random_points));
      return;
    }
    AddSfm();
    if (sfm_.size() < std::min(kPlentyOfPoints, budget_)) {
      AddRandom(static_cast<size_t>(run_.options.train.random_points));
    }
  }

  void AddHybrid() {
    const auto random = static_cast<size_t>(kRandomShare * static_cast<double>(budget_));
    AddDense(budget_ - std::min(budget_, random + sfm_.size()));
    AddSfm();
    AddRandom(random);
  }

  size_t Left() const { return budget_ - std::min(budget_, start_.cloud.xyz.size()); }

  void Add(const PointCloud& more, const std::string& source) {
    if (more.xyz.empty()) return;
    PointCloud& cloud = start_.cloud;
    // A point without a normal is as thick as it is wide.
    cloud.normals.resize(cloud.xyz.size(), Eigen::Vector3f::Zero());
    cloud.normals.insert(cloud.normals.end(), more.normals.begin(), more.normals.end());
    cloud.xyz.insert(cloud.xyz.end(), more.xyz.begin(), more.xyz.end());
    cloud.rgb.insert(cloud.rgb.end(), more.rgb.begin(), more.rgb.end());
    cloud.normals.resize(cloud.xyz.size(), Eigen::Vector3f::Zero());
    start_.source += (start_.source.empty() ? "" : "+") + source;
  }

  void AddDense(size_t most) {
    Add(DenseStart(run_.options.start, photos_, geometry_, std::min(most, Left())), "dense");
  }

  void AddSfm() {
    std::vector<ScenePoint> points = sfm_;
    const size_t limit = Left();
    if (points.size() > limit) {
      run_.listener(Note{fmt::format("starting from {} of {} points (--max-gaussians)", limit, points.size())});
      for (size_t i = 0; i < limit; ++i) points[i] = points[i * points.size() / limit];
      points.resize(limit);
    }
    Add(ToPointCloud(points), "sfm");
  }

  void AddRandom(size_t most) {
    const auto n = static_cast<int64_t>(std::min(most, Left()));
    if (run_.scene.format == SceneFormat::kBlender) {
      Add(RandomPointsInBlenderCube(n, run_.options.start.seed), "random");
      return;
    }
    std::vector<Camera> cameras;
    for (const int view : run_.split.train) {
      cameras.push_back(WorkingCamera(run_.scene.views[static_cast<size_t>(view)], run_.options.photo));
    }
    Add(RandomPointsInView(cameras, n, run_.options.start.seed), "random");
  }

  const Run& run_;
  const std::vector<LoadedView>& photos_;
  const std::vector<ScenePoint>& sfm_;
  const Geometry& geometry_;
  size_t budget_;
  StartPoints start_;
};

}  // namespace

PointCloud ToPointCloud(const std::vector<DensePoint>& points) {
  PointCloud cloud;
  for (const DensePoint& p : points) {
    cloud.xyz.push_back(p.xyz);
    cloud.rgb.push_back(p.rgb);
    cloud.normals.push_back(p.normal);
  }
  return cloud;
}

bool NeedsDepth(const RunOptions& options) {
  if (options.depth.depth_prior == "none") return false;
  const std::string& init = options.start.init;
  return ProposesViews(options) || !options.propose.proposal_folder.empty() || init == "auto" || init == "dense" ||
         init == "hybrid" || options.train.depth_weight > 0 || options.train.prune_floaters;
}

std::vector<ScenePoint> RunSfm(Run* run) {
  if (run->options.start.init == "random" && !NeedsDepth(run->options)) return {};
  const std::string key = Key(*run);
  const nlohmann::json before = run->workspace.Record("sfm");
  const bool done = run->workspace.IsDone("sfm", key);
  const StageClock clock("sfm", run->listener);
  for (const std::string& warning : PoseWarnings(run->scene, run->split.train)) run->listener(Warning{warning});
  std::vector<ScenePoint> points = PointsOfTrainingViews(*run);
  const double seconds = clock.Finish();
  run->workspace.MarkDone("sfm", {{"key", key},
                                  {"seconds", done ? before.value("seconds", seconds) : seconds},
                                  {"points", points.size()},
                                  {"files", nlohmann::json::array()}});
  return points;
}

PointCloud DenseStart(const StartOptions& options, const std::vector<LoadedView>& photos, const Geometry& geometry,
                      size_t budget) {
  if (budget == 0) return {};
  std::vector<DensePoint> points = geometry.points;
  if (options.init_planes == "yes") {
    const std::vector<DensePoint> more = FillPlanes(geometry.maps, photos, points, FusionOf(geometry.gains));
    points.insert(points.end(), more.begin(), more.end());
  }
  const std::vector<DensePoint> guessed = PriorPoints(geometry.maps, photos, points, FusionOf(geometry.gains));
  points.insert(points.end(), guessed.begin(), guessed.end());
  return ToPointCloud(Thinned(points, budget, options.seed));
}

StartPoints ChooseStart(Run* run, const std::vector<LoadedView>& photos, const std::vector<ScenePoint>& sfm,
                        const Geometry& geometry) {
  StartPoints start = StartBuilder(*run, photos, sfm, geometry).Build();
  run->listener(Note{fmt::format("starting from {} points ({})", start.cloud.xyz.size(), start.source)});
  run->workspace.MarkDone("start", {{"key", ""},
                                    {"seconds", 0},
                                    {"source", start.source},
                                    {"points", start.cloud.xyz.size()},
                                    {"files", nlohmann::json::array()}});
  return start;
}

}  // namespace oraclegs
