#include "oraclegs/depth/scene_planes.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/parallel.h"

namespace oraclegs {
namespace {

constexpr size_t kMaxPlanes = 24, kMaxSamples = 20000, kMaxDraws = 200;
constexpr float kMinShare = 0.005f;  // of the points, for a plane
constexpr float kMaxPixelsOff = 5;
constexpr float kSameNormal = 0.8f;  // cosine
constexpr int kPlaneRefinements = 2;
constexpr float kUpright = 0.3f;  // cosine between planes that may stand upright on a third
constexpr size_t kMaxUprights = 6;
constexpr size_t kMinPoints = 500;

bool LiesOn(const ScenePlane& plane, const DensePoint& p) {
  return std::abs(plane.Distance(p.xyz)) < kMaxPixelsOff * p.pixel_size &&
         std::abs(plane.normal.dot(p.normal)) > kSameNormal;
}

size_t Support(const ScenePlane& plane, const std::vector<const DensePoint*>& points) {
  return static_cast<size_t>(
      std::count_if(points.begin(), points.end(), [&](const DensePoint* p) { return LiesOn(plane, *p); }));
}

/// Least-squares plane of its points, weighed by the size of their pixels.
ScenePlane Refined(const ScenePlane& plane, const std::vector<const DensePoint*>& points) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  double total = 0;
  const auto weight = [](const DensePoint& p) { return 1.0 / (static_cast<double>(p.pixel_size) * p.pixel_size); };
  for (const DensePoint* p : points) {
    if (!LiesOn(plane, *p)) continue;
    mean += weight(*p) * p->xyz.cast<double>();
    total += weight(*p);
  }
  if (!(total > 0)) return plane;
  mean /= total;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const DensePoint* p : points) {
    if (!LiesOn(plane, *p)) continue;
    const Eigen::Vector3d d = p->xyz.cast<double>() - mean;
    spread += weight(*p) * d * d.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread);
  Eigen::Vector3d normal = axes.eigenvectors().col(0);
  if (normal.dot(plane.normal.cast<double>()) < 0) normal = -normal;
  return {normal.cast<float>(), static_cast<float>(-normal.dot(mean))};
}

/// Directions perpendicular to two planes each.
std::vector<Eigen::Vector3f> Uprights(const std::vector<ScenePlane>& planes) {
  std::vector<Eigen::Vector3f> directions;
  for (size_t a = 0; a < planes.size(); ++a) {
    for (size_t b = 0; b < a && directions.size() < kMaxUprights; ++b) {
      if (std::abs(planes[a].normal.dot(planes[b].normal)) > kUpright) continue;
      directions.push_back(planes[a].normal.cross(planes[b].normal).normalized());
    }
  }
  return directions;
}

}  // namespace

std::vector<ScenePlane> FindPlanes(const std::vector<DensePoint>& points) {
  std::vector<ScenePlane> planes;
  if (points.size() < kMinPoints) return planes;
  std::vector<const DensePoint*> left;
  const size_t stride = (points.size() + kMaxSamples - 1) / kMaxSamples;
  for (size_t i = 0; i < points.size(); i += stride) left.push_back(&points[i]);
  const auto min_support = static_cast<size_t>(kMinShare * static_cast<float>(left.size()));
  while (planes.size() < kMaxPlanes && left.size() > min_support) {
    ThrowIfInterrupted();
    // Normals of ground and tables, seen at a grazing angle, are too noisy to draw from; those of walls define them.
    const std::vector<Eigen::Vector3f> uprights = Uprights(planes);
    const size_t draws = std::min(kMaxDraws, left.size()), kinds = uprights.size() + 1;
    std::vector<size_t> support(draws * kinds);
    const auto plane_of = [&](size_t draw) {
      const DensePoint& p = *left[draw / kinds * left.size() / draws];
      const size_t kind = draw % kinds;
      const Eigen::Vector3f& normal = kind == 0 ? p.normal : uprights[kind - 1];
      return ScenePlane{normal, -normal.dot(p.xyz)};
    };
    ParallelFor(static_cast<int64_t>(support.size()), [&](int64_t d) {
      const auto draw = static_cast<size_t>(d);
      support[draw] = Support(plane_of(draw), left);
    });
    const auto best = std::max_element(support.begin(), support.end());
    ScenePlane plane = plane_of(static_cast<size_t>(best - support.begin()));
    for (int i = 0; i < kPlaneRefinements; ++i) plane = Refined(plane, left);
    if (Support(plane, left) < min_support) break;
    planes.push_back(plane);
    std::erase_if(left, [&](const DensePoint* p) { return LiesOn(plane, *p); });
  }
  return planes;
}

}  // namespace oraclegs
