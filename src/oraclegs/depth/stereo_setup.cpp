#include "oraclegs/depth/stereo_setup.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "oraclegs/camera/scene_bounds.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/core/rng.h"

namespace oraclegs {
namespace {

constexpr size_t kMinPointsForRange = 20;                // points of a view
constexpr int kMinPointsForPair = 8;                     // points two views share
constexpr double kObjectReach = 0.45;                    // of the distance, for an object within silhouettes
constexpr double kSceneNear = 0.2, kSceneFar = 20;       // of the distance, for a scene without points
constexpr double kMinAngle = 0.5;                        // degrees: below, noise decides the depth
constexpr double kBestAngle = 10, kMaxSearchAngle = 60;  // degrees
constexpr double kNarrowSigma = 5, kWideSigma = 15;      // degrees
constexpr int kRandomPoints = 1000;
constexpr double kRandomPointRadius = 0.25;  // of the ball the cameras look at

bool InFrame(const Camera& camera, const Eigen::Vector3d& point) {
  const Eigen::Vector3d p = camera.cam_from_world * point;
  if (!(p.z() > 0)) return false;
  const double x = camera.fx * p.x() / p.z() + camera.cx, y = camera.fy * p.y() / p.z() + camera.cy;
  return x >= 0 && y >= 0 && x < camera.width && y < camera.height;
}

double AngleScore(double angle) {
  if (angle < kMinAngle || angle >= kMaxSearchAngle) return 0;
  const double sigma = angle < kBestAngle ? kNarrowSigma : kWideSigma;
  return std::exp(-std::pow((angle - kBestAngle) / sigma, 2) / 2);
}

/// Random points in the volume that the cameras look at.
std::vector<Eigen::Vector3d> RandomPoints(const std::vector<Camera>& cameras) {
  const Ball ball = LookedAt(cameras);
  Rng rng(0, RandomStream::kStereoStandIns);
  std::vector<Eigen::Vector3d> points;
  while (points.size() < kRandomPoints) {
    const Eigen::Vector3d p(rng.Uniform(-1, 1), rng.Uniform(-1, 1), rng.Uniform(-1, 1));
    if (p.squaredNorm() <= 1) points.push_back(ball.center + kRandomPointRadius * ball.radius * p);
  }
  return points;
}

/// Two quantiles of depth, each with a factor as margin.
struct RangeMargins {
  double near_quantile, far_quantile, near_margin, far_margin;
};
constexpr RangeMargins kSceneSpan{0.003, 0.995, 0.3, 2.5};
constexpr RangeMargins kObjectSpan{0.05, 0.95, 0.9,
                                   1.1};  // an object is no larger than its points, a few of which are wrong

DepthRange RangeFromDepths(std::vector<double> depths, const RangeMargins& span) {
  std::sort(depths.begin(), depths.end());
  const auto quantile = [&](double q) {
    return depths[static_cast<size_t>(q * static_cast<double>(depths.size() - 1))];
  };
  return {static_cast<float>(1 / (span.far_margin * quantile(span.far_quantile))),
          static_cast<float>(1 / (span.near_margin * quantile(span.near_quantile)))};
}

/// The scores of points that two views share.
struct SharedScore {
  double sum = 0;
  int points = 0;

  void Add(double score) { sum += score, ++points; }
  double Mean() const { return points > 0 ? sum / points : 0; }
};

}  // namespace

double AngleAt(const Eigen::Vector3d& point, const Camera& a, const Camera& b) {
  const Eigen::Vector3d to_a = (a.Center() - point).normalized(), to_b = (b.Center() - point).normalized();
  return std::acos(std::clamp(to_a.dot(to_b), -1.0, 1.0)) * 180 / M_PI;
}

std::vector<DepthRange> FindDepthRanges(const std::vector<LoadedView>& views, const std::vector<ScenePoint>& points,
                                        const Silhouettes& silhouettes) {
  std::vector<std::vector<double>> depths(views.size());
  for (const ScenePoint& point : points) {
    for (size_t v = 0; v < views.size(); ++v) {
      // All points in frame, also occluded ones: the bounds then hold for surfaces without points, too.
      if (InFrame(views[v].camera, point.xyz)) depths[v].push_back((views[v].camera.cam_from_world * point.xyz).z());
    }
  }
  const Ball ball = LookedAt(CamerasOf(views));
  std::vector<DepthRange> ranges;
  for (size_t v = 0; v < views.size(); ++v) {
    const double distance = (views[v].camera.Center() - ball.center).norm();
    if (!silhouettes.empty() && distance > 0) {
      DepthRange range{static_cast<float>(1 / ((1 + kObjectReach) * distance)),
                       static_cast<float>(1 / ((1 - kObjectReach) * distance))};
      if (depths[v].size() >= kMinPointsForRange) {  // near-parallel axes fix the distance badly, points well
        const DepthRange seen = RangeFromDepths(std::move(depths[v]), kObjectSpan);
        range = {std::min(range.far, seen.far), std::max(range.near, seen.near)};
      }
      ranges.push_back(range);
    } else if (depths[v].size() >= kMinPointsForRange) {
      ranges.push_back(RangeFromDepths(std::move(depths[v]), kSceneSpan));
    } else {
      const double scale = distance > 0 ? distance : ball.radius;
      ranges.push_back({static_cast<float>(1 / (kSceneFar * scale)), static_cast<float>(1 / (kSceneNear * scale))});
    }
  }
  return ranges;
}

std::vector<std::vector<int>> FindNeighbors(const std::vector<LoadedView>& views, const std::vector<ScenePoint>& points,
                                            int most) {
  return FindNeighbors(views, points, most, [](size_t) { return true; });
}

std::vector<std::vector<int>> FindNeighbors(const std::vector<LoadedView>& views, const std::vector<ScenePoint>& points,
                                            int most, FunctionRef<bool(size_t)> is_wanted) {
  const std::vector<Eigen::Vector3d> random_points = RandomPoints(CamerasOf(views));
  const size_t n = views.size();
  std::vector<std::vector<int>> neighbors(n);
  ParallelFor(static_cast<int64_t>(n), [&](int64_t view) {
    const auto a = static_cast<size_t>(view);
    if (!is_wanted(a)) return;
    const Camera& camera_a = views[a].camera;
    const auto score_with = [&](size_t b, const Eigen::Vector3d& point) {
      return AngleScore(AngleAt(point, camera_a, views[b].camera));
    };
    std::vector<SharedScore> shared(n);
    for (const ScenePoint& point : points) {
      if (std::find(point.views.begin(), point.views.end(), static_cast<int>(a)) == point.views.end()) continue;
      for (const int v : point.views) {
        const auto b = static_cast<size_t>(v);
        if (b != a) shared[b].Add(score_with(b, point.xyz));
      }
    }
    std::vector<std::pair<double, int>> scores;
    for (size_t b = 0; b < n; ++b) {
      if (b == a) continue;
      if (shared[b].points < kMinPointsForPair) {
        for (const Eigen::Vector3d& p : random_points) {
          if (InFrame(camera_a, p) && InFrame(views[b].camera, p)) shared[b].Add(score_with(b, p));
        }
      }
      if (shared[b].Mean() > 0) scores.emplace_back(-shared[b].Mean(), static_cast<int>(b));
    }
    std::sort(scores.begin(), scores.end());
    for (size_t k = 0; k < scores.size() && static_cast<int>(k) < most; ++k) neighbors[a].push_back(scores[k].second);
  });
  return neighbors;
}

std::vector<size_t> ViewsForStereo(const std::vector<Camera>& cameras) {
  const size_t n = cameras.size();
  std::vector<size_t> chosen;
  if (n <= kMaxStereoViews) {
    for (size_t v = 0; v < n; ++v) chosen.push_back(v);
    return chosen;
  }
  const Ball ball = LookedAt(cameras);
  const auto apart = [&](const Camera& a, const Camera& b) {
    return (a.Center() - b.Center()).norm() / ball.radius + TurnBetween(a, b);
  };
  // Always the one farthest from those chosen so far.
  std::vector<double> distance(n, std::numeric_limits<double>::infinity());
  for (size_t next = 0; chosen.size() < kMaxStereoViews;) {
    chosen.push_back(next);
    for (size_t v = 0; v < n; ++v) distance[v] = std::min(distance[v], apart(cameras[v], cameras[next]));
    next = static_cast<size_t>(std::max_element(distance.begin(), distance.end()) - distance.begin());
    if (!(distance[next] > 0)) break;  // the others are where these are
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

}  // namespace oraclegs
