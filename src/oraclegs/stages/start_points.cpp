#include "oraclegs/stages/start_points.h"

#include <algorithm>
#include <utility>

#include "oraclegs/core/text.h"
#include "oraclegs/depth/plane_fill.h"
#include "oraclegs/depth/prior_points.h"
#include "oraclegs/stages/sfm_stage.h"

namespace oraclegs {
namespace {

constexpr size_t kMinPointsForScale = 4;  // a point needs three neighbors to have a scale
constexpr double kRandomShare = 0.1;      // of the budget, in a hybrid start

/// The points of one --init word after the other, within the budget.
class StartBuilder {
 public:
  StartBuilder(const Run& run, const StartEvidence& known)
      : run_(run),
        views_(known.views),
        sfm_(known.sfm),
        geometry_(known.geometry),
        budget_(static_cast<size_t>(run.options.train.max_gaussians.value())) {}

  StartPoints Build() {
    const Auto<StartKind>& init = run_.options.start.init;
    if (init == StartKind::kRandom || init == StartKind::kRandomCube) {
      AddRandom(static_cast<size_t>(run_.options.train.random_points));
    } else if (init == StartKind::kSfm) {
      Require(sfm_.size(), "the training views gave {} points, too few to start from; use --init random");
      AddSfm();
    } else if (init == StartKind::kDense) {
      Require(geometry_.points.size(), "stereo gave {} points, too few to start from; use --init sfm or --init random");
      AddDense(budget_);
    } else if (init == StartKind::kHybrid) {
      AddHybrid();
    } else {
      AddBest();
    }
    return std::move(start_);
  }

 private:
  void Require(size_t points, const char* message) const {
    if (points >= kMinPointsForScale) return;
    throw InputError("{}: {}", run_.scene.root.string(), fmt::format(fmt::runtime(message), points));
  }

  void AddBest() {
    if (geometry_.points.size() >= kMinPointsForStart) {
      AddDense(budget_);
      return;
    }
    if (run_.plan.needs_depth) {
      run_.listener(Warning{fmt::format(
          "stereo gave {} points only: the photos overlap too little, or their surfaces have no texture; starting "
          "without them",
          geometry_.points.size())});
    }
    if (sfm_.size() < kMinSparseStart) {
      run_.listener(
          Warning{fmt::format("the training views gave {} points, fewer than {}: starting from random points, which "
                              "reconstructs fine detail less well",
                              sfm_.size(), kMinSparseStart)});
      AddRandom(static_cast<size_t>(run_.options.train.random_points));
      return;
    }
    AddSfm();
    if (sfm_.size() < std::min(kMinPointsForStart, budget_)) {
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
    cloud.xyz.insert(cloud.xyz.end(), more.xyz.begin(), more.xyz.end());
    cloud.rgb.insert(cloud.rgb.end(), more.rgb.begin(), more.rgb.end());
    start_.source += (start_.source.empty() ? "" : "+") + source;
  }

  void AddDense(size_t limit) {
    Add(DenseStart(run_.options.start, views_, geometry_, std::min(limit, Left())), "dense");
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

  void AddRandom(size_t limit) {
    const auto n = static_cast<int64_t>(std::min(limit, Left()));
    if (run_.scene.format == SceneFormat::kBlender) {
      Add(RandomPointsInBlenderCube(n, run_.options.start.seed), "random");
      return;
    }
    const std::vector<Camera> cameras = WorkingCameras(run_.scene, run_.split.train, run_.options.image);
    const uint64_t seed = run_.options.start.seed;
    const bool in_cube = run_.options.start.init == StartKind::kRandomCube;
    Add(in_cube ? RandomPointsInCube(cameras, n, seed) : RandomPointsInView(cameras, n, seed), "random");
  }

  const Run& run_;
  const std::vector<LoadedView>& views_;
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
  }
  return cloud;
}

PointCloud DenseStart(const StartOptions& options, const std::vector<LoadedView>& views, const Geometry& geometry,
                      size_t budget) {
  if (budget == 0) return {};
  std::vector<DensePoint> points = geometry.points;
  if (options.init_planes) {
    const std::vector<DensePoint> more = FillPlanes(geometry.maps, views, points, FusionOf(geometry.gains));
    points.insert(points.end(), more.begin(), more.end());
  }
  const std::vector<DensePoint> predicted = PriorPoints(geometry.maps, views, points, FusionOf(geometry.gains));
  points.insert(points.end(), predicted.begin(), predicted.end());
  return ToPointCloud(Thinned(points, budget, options.seed));
}

StartPoints ChooseStart(Run* run, const StartEvidence& known) {
  StartPoints start = StartBuilder(*run, known).Build();
  run->listener(Note{fmt::format("starting from {} ({})", Counted(start.cloud.xyz.size(), "point"), start.source)});
  run->workspace.MarkDone("start", {{"key", ""},
                                    {"seconds", 0},
                                    {"source", start.source},
                                    {"points", start.cloud.xyz.size()},
                                    {"files", nlohmann::json::array()}});
  return start;
}

InitializeOptions InitializeOptionsOf(const StartOptions& options, double usual_scale) {
  return {options.init_scale.ValueOr(usual_scale), options.init_opacity};
}

}  // namespace oraclegs
