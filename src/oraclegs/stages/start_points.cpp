#include "oraclegs/stages/start_points.h"

#include <algorithm>
#include <utility>

#include "oraclegs/core/text.h"
#include "oraclegs/depth/fusion.h"
#include "oraclegs/settings/from_results.h"

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
    if (const std::filesystem::path& file = run_.options.start.init_points; !file.empty()) {
      AddFile(file);
      return std::move(start_);
    }
    const StartCounts found{geometry_.points.size(), sfm_.size(), budget_, run_.plan.needs_depth};
    for (const StartKind kind : SettleStart(run_.options.start, found, run_.listener)) Add(kind);
    return std::move(start_);
  }

 private:
  void Require(size_t points, const char* message) const {
    if (points >= kMinPointsForScale) return;
    throw InputError("{}: {}", run_.scene.root.string(), fmt::format(fmt::runtime(message), points));
  }

  void Add(StartKind kind) {
    switch (kind) {
      case StartKind::kDense:
        Require(geometry_.points.size(),
                "stereo gave {} points, too few to start from; use --init sfm or --init random");
        return AddDense(budget_);
      case StartKind::kSfm:
        Require(sfm_.size(), "the training views gave {} points, too few to start from; use --init random");
        return AddSfm();
      case StartKind::kHybrid:
        return AddHybrid();
      case StartKind::kRandom:
      case StartKind::kRandomCube:
        return AddRandom(static_cast<size_t>(run_.options.train.random_points), kind == StartKind::kRandomCube);
    }
  }

  void AddFile(const std::filesystem::path& file) {
    PointCloud cloud = ReadPointPly(file);
    if (cloud.xyz.size() < kMinPointsForScale) {
      throw InputError("{}: holds {}, too few to start from", file.string(), Counted(cloud.xyz.size(), "point"));
    }
    const Similarity run_from_scene = RunFromScene(run_.frame);
    for (Eigen::Vector3f& point : cloud.xyz) point = (run_from_scene * point.cast<double>()).cast<float>();
    Append(Thinned(std::move(cloud)), "file");
  }

  /// At most as many points as there is budget left for, evenly spaced in their list.
  PointCloud Thinned(PointCloud cloud) const {
    const size_t limit = Left(), n = cloud.xyz.size();
    if (n <= limit) return cloud;
    run_.listener(Note{fmt::format("starting from {} of {} points (--max-gaussians)", limit, n)});
    for (size_t i = 0; i < limit; ++i) {
      cloud.xyz[i] = cloud.xyz[i * n / limit];
      cloud.rgb[i] = cloud.rgb[i * n / limit];
    }
    cloud.xyz.resize(limit), cloud.rgb.resize(limit);
    return cloud;
  }

  void AddHybrid() {
    const auto random = static_cast<size_t>(kRandomShare * static_cast<double>(budget_));
    AddDense(budget_ - std::min(budget_, random + sfm_.size()));
    AddSfm();
    AddRandom(random, false);
  }

  size_t Left() const { return budget_ - std::min(budget_, start_.cloud.xyz.size()); }

  void Append(const PointCloud& more, const std::string& source) {
    if (more.xyz.empty()) return;
    PointCloud& cloud = start_.cloud;
    cloud.xyz.insert(cloud.xyz.end(), more.xyz.begin(), more.xyz.end());
    cloud.rgb.insert(cloud.rgb.end(), more.rgb.begin(), more.rgb.end());
    start_.source += (start_.source.empty() ? "" : "+") + source;
  }

  void AddDense(size_t limit) {
    Append(DenseStart(run_.options.start, views_, geometry_, std::min(limit, Left())), "dense");
  }

  void AddSfm() { Append(Thinned(ToPointCloud(sfm_)), "sfm"); }

  void AddRandom(size_t limit, bool in_cube) {
    const auto n = static_cast<int64_t>(std::min(limit, Left()));
    if (run_.scene.format == SceneFormat::kBlender) {
      Append(RandomPointsInBlenderCube(n, run_.options.start.seed), "random");
      return;
    }
    const std::vector<Camera> cameras = WorkingCameras(run_.scene, run_.split.train, run_.plan.image);
    const uint64_t seed = run_.options.start.seed;
    Append(in_cube ? RandomPointsInCube(cameras, n, seed) : RandomPointsInView(cameras, n, seed), "random");
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

}  // namespace oraclegs
