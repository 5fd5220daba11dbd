#include "oraclegs/sfm/pose_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "oraclegs/camera/distortion_models.h"
#include "oraclegs/core/statistics.h"
#include "oraclegs/core/text.h"
#include "oraclegs/scene/scene.h"
#include "oraclegs/sfm/colmap_database.h"
#include "oraclegs/sfm/colmap_runner.h"
#include "oraclegs/sfm/colmap_staging.h"
#include "oraclegs/sfm/colmap_workspace.h"

namespace oraclegs {
namespace {

constexpr double kMinBaseline = 1e-3;         // of the distance looked at: 0.06 degrees of parallax, below a pixel
constexpr double kRounding = 1e-6;            // of the distance from the origin, times kSamePlace: what doubles round
constexpr double kSamePlace = 1e-6;           // of the extent of the cameras: rounding of a file with six digits
constexpr double kSameDirection = 1e-4;       // radians
constexpr double kMinOverlap = .02;           // of what a view sees
constexpr double kMinSquaredSine = 1e-6;      // squared sine of the angle between two axes: a twentieth of a degree
constexpr size_t kMinPointsForDistance = 10;  // fewer say nothing of the distance
constexpr int kPixelSamples = 6;              // along each side of the image
constexpr int kDepthSamples = 6;              // from half to twice the distance looked at
constexpr double kMinDepthInBaselines = .1;   // where that distance is not known: of that to the nearest camera
constexpr double kMaxDepthInBaselines = 100;

struct PosedView {
  const SceneView* view;
  Eigen::Vector3d center;
  Eigen::Vector3d forward;  ///< unit length
  DistortionMap map;
};

std::vector<PosedView> PosedViews(const Scene& scene, const std::vector<int>& views) {
  std::vector<PosedView> posed;
  for (const int v : views) {
    const SceneView& view = scene.views.at(static_cast<size_t>(v));
    if (!view.cam_from_world || view.intrinsics.params.empty()) continue;
    posed.push_back({&view, view.cam_from_world->inverse().translation(),
                     view.cam_from_world->linear().row(2).transpose(), DistortionMap(view.intrinsics)});
  }
  return posed;
}

/// The largest distance between two cameras.
double LargestBaseline(const std::vector<PosedView>& views) {
  double largest = 0;
  for (const PosedView& a : views) {
    for (const PosedView& b : views) largest = std::max(largest, (a.center - b.center).norm());
  }
  return largest;
}

std::optional<double> MedianDepthOfPoints(const Scene& scene, const std::vector<PosedView>& views) {
  std::vector<double> depths;
  for (const ScenePoint& point : scene.points) {
    for (const PosedView& v : views) {
      const double depth = v.forward.dot(point.xyz - v.center);
      if (depth > 0) depths.push_back(depth);
    }
  }
  if (depths.size() < kMinPointsForDistance) return std::nullopt;
  return UpperMedian(std::move(depths));
}

/// Where the axis of `view` passes nearest to that of `other`, along it; nothing when they run in parallel or meet
/// behind one of the two.
std::optional<double> DepthOfMeeting(const PosedView& view, const PosedView& other, double extent) {
  const Eigen::Vector3d apart = other.center - view.center;
  const double cosine = view.forward.dot(other.forward), along = apart.dot(view.forward);
  const double along_other = apart.dot(other.forward), sine2 = 1 - cosine * cosine;
  if (sine2 < kMinSquaredSine) return std::nullopt;
  const double depth = (along - cosine * along_other) / sine2;
  const double depth_of_other = (cosine * along - along_other) / sine2;
  if (depth < kSamePlace * extent || depth_of_other < kSamePlace * extent) return std::nullopt;
  return depth;
}

/// How far away each view's subject is: the median depth of the scene's points or, without them, of where its axis
/// meets the others'.
std::vector<std::optional<double>> DistancesLookedAt(const Scene& scene, const std::vector<PosedView>& views,
                                                     double extent) {
  const std::optional<double> by_points = MedianDepthOfPoints(scene, views);
  std::vector<std::optional<double>> distances(views.size(), by_points);
  if (by_points) return distances;
  for (size_t i = 0; i < views.size(); ++i) {
    std::vector<double> depths;
    for (size_t j = 0; j < views.size(); ++j) {
      const std::optional<double> depth = i == j ? std::nullopt : DepthOfMeeting(views[i], views[j], extent);
      if (depth) depths.push_back(*depth);
    }
    if (!depths.empty()) distances[i] = UpperMedian(std::move(depths));
  }
  return distances;
}

bool OnePoint(const std::vector<PosedView>& views, const std::vector<std::optional<double>>& distances, double extent) {
  const double baseline = LargestBaseline(views);
  if (baseline <= kSamePlace * extent) return true;
  std::vector<double> known;
  for (const std::optional<double>& distance : distances) {
    if (distance) known.push_back(*distance);
  }
  return !known.empty() && baseline < kMinBaseline * UpperMedian(std::move(known));
}

/// Groups of two views or more that stand in one place and look one way.
std::vector<std::vector<std::string>> SamePoses(const std::vector<PosedView>& views, double extent) {
  std::vector<std::vector<std::string>> groups;
  std::vector<bool> grouped(views.size(), false);
  for (size_t i = 0; i < views.size(); ++i) {
    if (grouped[i]) continue;
    std::vector<std::string> names{views[i].view->name};
    for (size_t j = i + 1; j < views.size(); ++j) {
      const Eigen::Matrix3d rotation =
          views[i].view->cam_from_world->linear() * views[j].view->cam_from_world->linear().transpose();
      // |R - I| (Frobenius) is sqrt(2) times the angle when that is small; the trace would lose half of the digits.
      const double angle = (rotation - Eigen::Matrix3d::Identity()).norm() / std::sqrt(2.);
      if (angle > kSameDirection || (views[i].center - views[j].center).norm() > kSamePlace * extent) continue;
      grouped[j] = true;
      names.push_back(views[j].view->name);
    }
    if (names.size() > 1) groups.push_back(std::move(names));
  }
  return groups;
}

struct DepthRange {
  double near, far;
};

/// Where what a view looks at may be, along its axis.
DepthRange RangeLookedAt(const std::vector<PosedView>& views, size_t index, std::optional<double> distance) {
  if (distance) return {*distance / 2, *distance * 2};
  double nearest = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < views.size(); ++i) {
    const double baseline = (views[i].center - views[index].center).norm();
    if (i != index && baseline > 0) nearest = std::min(nearest, baseline);
  }
  if (!std::isfinite(nearest)) nearest = 1;  // all cameras in one place: then every depth gives the same answer
  return {nearest * kMinDepthInBaselines, nearest * kMaxDepthInBaselines};
}

bool Sees(const PosedView& view, const Eigen::Vector3d& world) {
  const Eigen::Vector3d in_camera = *view.view->cam_from_world * world;
  return in_camera.z() > 0 && view.map.Sees(in_camera.x() / in_camera.z(), in_camera.y() / in_camera.z());
}

/// The share of samples of a view's volume that another view sees too.
double SharedVolume(const std::vector<PosedView>& views, size_t index, const DepthRange& range) {
  const SceneView& view = *views[index].view;
  const Eigen::Isometry3d world_from_cam = view.cam_from_world->inverse();
  int samples = 0, shared = 0;
  for (int i = 0; i < kPixelSamples * kPixelSamples; ++i) {
    const auto ray = views[index].map.Unproject(view.intrinsics.width * (i % kPixelSamples + .5) / kPixelSamples,
                                                view.intrinsics.height * (i / kPixelSamples + .5) / kPixelSamples);
    if (!ray) continue;
    for (int k = 0; k < kDepthSamples; ++k) {
      const double depth = range.near * std::pow(range.far / range.near, (k + .5) / kDepthSamples);
      const Eigen::Vector3d world = world_from_cam * (Eigen::Vector3d(ray->x(), ray->y(), 1) * depth);
      ++samples;
      for (size_t other = 0; other < views.size(); ++other) {
        if (other == index || !Sees(views[other], world)) continue;
        ++shared;
        break;
      }
    }
  }
  return samples > 0 ? static_cast<double>(shared) / samples : 1;
}

std::string NearestView(const std::vector<PosedView>& views, size_t index) {
  size_t nearest = index == 0 ? 1 : 0;
  for (size_t i = 0; i < views.size(); ++i) {
    if (i == index) continue;
    const auto distance = [&](size_t j) { return (views[j].center - views[index].center).norm(); };
    if (distance(i) < distance(nearest)) nearest = i;
  }
  return views[nearest].view->name;
}

namespace fs = std::filesystem;

constexpr size_t kNeighbors = 3;
constexpr int kCheckImageSide = 800, kCheckFeatures = 1500;

void Match(const Scene& scene, const std::vector<int>& views, const std::vector<StagedView>& plan,
           const ColmapRunner& colmap, bool has_masks) {
  colmap.ExtractFeatures("SIMPLE_PINHOLE", has_masks,
                         {{"SiftExtraction.max_image_size", std::to_string(kCheckImageSide)},
                          {"SiftExtraction.max_num_features", std::to_string(kCheckFeatures)}});
  std::map<uint32_t, Intrinsics> cameras;
  const auto stored = ReadDatabaseImages(colmap.database());
  for (size_t i = 0; i < views.size(); ++i) {
    const auto found = stored.find(plan[i].name);
    if (found != stored.end()) cameras[found->second.camera_id] = scene.views[static_cast<size_t>(views[i])].intrinsics;
  }
  SetDatabaseCameras(colmap.database(), cameras);
  std::vector<std::pair<std::string, std::string>> names;
  for (const auto& [a, b] : NeighborsByPoints(scene, views))
    names.emplace_back(plan[static_cast<size_t>(a)].name, plan[static_cast<size_t>(b)].name);
  colmap.MatchPairs(names, {}, "matching");
}

}  // namespace

std::vector<std::string> PoseWarnings(const Scene& scene, const std::vector<int>& train_views) {
  const std::vector<PosedView> views = PosedViews(scene, train_views);
  if (views.size() < 2) return {};
  std::vector<std::string> warnings;
  double extent = LargestBaseline(views);
  for (const PosedView& v : views) extent = std::max(extent, kRounding * v.center.norm());
  const std::vector<std::optional<double>> distances = DistancesLookedAt(scene, views, extent);
  for (const std::vector<std::string>& names : SamePoses(views, extent)) {
    warnings.push_back(
        fmt::format("{} have one and the same pose, so they show no depth against each other; correct the poses, or "
                    "leave out all but one",
                    SomeNames(names)));
  }
  if (OnePoint(views, distances, extent)) {
    warnings.push_back(
        fmt::format("the {} training photos were taken from one point, so depth cannot be found; move sideways between "
                    "photos instead of only turning the camera",
                    views.size()));
    return warnings;  // how far such views overlap no longer matters
  }
  std::vector<std::string> alone;
  std::string nearest;
  for (size_t i = 0; i < views.size(); ++i) {
    if (SharedVolume(views, i, RangeLookedAt(views, i, distances[i])) >= kMinOverlap) continue;
    if (alone.empty()) nearest = NearestView(views, i);
    alone.push_back(views[i].view->name);
  }
  if (alone.size() == 1) {
    warnings.push_back(
        fmt::format("{} sees nothing that another training photo sees, so its depth cannot be found; add a "
                    "photo between it and {}, or correct its pose",
                    alone[0], nearest));
  } else if (!alone.empty()) {
    warnings.push_back(
        fmt::format("{} each see nothing that another training photo sees, so their depth cannot be found; add "
                    "photos between them and their neighbors, or correct their poses",
                    SomeNames(alone)));
  }
  return warnings;
}

std::vector<std::pair<int, int>> NeighborsByPoints(const Scene& scene, const std::vector<int>& views) {
  std::map<int, int> position;
  for (size_t i = 0; i < views.size(); ++i) position[views[i]] = static_cast<int>(i);
  const size_t n = views.size();
  std::vector<std::vector<int>> common(n, std::vector<int>(n, 0));
  for (const ScenePoint& point : scene.points) {
    std::vector<size_t> seen;
    for (const int view : point.views) {
      if (const auto found = position.find(view); found != position.end())
        seen.push_back(static_cast<size_t>(found->second));
    }
    for (const size_t a : seen) {
      for (const size_t b : seen) common[a][b] += a != b;
    }
  }
  std::set<std::pair<int, int>> pairs;
  for (size_t a = 0; a < n; ++a) {
    std::vector<int> others;
    for (size_t b = 0; b < n; ++b) {
      if (common[a][b] > 0) others.push_back(static_cast<int>(b));
    }
    std::stable_sort(others.begin(), others.end(), [&](int x, int y) {
      return common[a][static_cast<size_t>(x)] > common[a][static_cast<size_t>(y)];
    });
    if (others.size() > kNeighbors) others.resize(kNeighbors);
    for (const int b : others) pairs.insert(std::minmax(static_cast<int>(a), b));
  }
  return {pairs.begin(), pairs.end()};
}

void MatchForCheck(const Scene& scene, const std::vector<int>& views, const fs::path& work_dir,
                   const Listener& listener) {
  const nlohmann::json inputs = DescribeInputs(scene, views);
  if (IsUnchanged(work_dir, inputs)) return;
  if (!ColmapAvailable()) {
    listener(Note{"the given poses are not checked: the colmap program is not installed (Debian: apt install colmap)"});
    return;
  }
  ClearWorkDir(work_dir);
  const std::vector<StagedView> plan = PlanStaging(scene, views);
  try {
    MakeFolder(AttemptsFolder(work_dir));
    const bool has_masks = StageImages(scene, views, plan, work_dir);
    Match(scene, views, plan, ColmapRunner(work_dir, listener, "sfm"), has_masks);
  } catch (const ColmapFailure& failure) {
    listener(Note{fmt::format("the given poses are not checked: {}; see {}", failure.Text(),
                              (work_dir / "colmap.log").string())});
    return;
  }
  MarkDone(work_dir, inputs);
  RemoveAttempts(work_dir);
}

}  // namespace oraclegs
