#include "oraclegs/camera/scene_bounds.h"

#include <Eigen/Dense>
#include <algorithm>
#include <utility>

#include "oraclegs/core/statistics.h"

namespace oraclegs {
namespace {

constexpr double kMinAxisSpread = 1e-3;  // below, the point nearest to all axes is ill-determined
constexpr double kFallbackReach = 3;     // extents; scenes seen side by side begin about there

double MedianDistance(const std::vector<Camera>& cameras, const Eigen::Vector3d& point) {
  std::vector<double> distances;
  for (const Camera& c : cameras) distances.push_back((c.Center() - point).norm());
  return UpperMedian(&distances);
}

}  // namespace

double SpatialExtent(const std::vector<Camera>& cameras) {
  if (cameras.empty()) return 0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Camera& c : cameras) mean += c.Center();
  mean /= static_cast<double>(cameras.size());
  double farthest = 0;
  for (const Camera& c : cameras) farthest = std::max(farthest, (c.Center() - mean).norm());
  return 1.1 * farthest;
}

Ball LookedAt(const std::vector<Camera>& cameras) {
  const auto n = static_cast<double>(cameras.size());
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero(), eye = right, forward = right;
  for (const Camera& c : cameras) {
    const Eigen::Vector3d f = c.Forward();
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - f * f.transpose();
    normal += across / n;
    right += across * c.Center() / n;
    eye += c.Center() / n;
    forward += f / n;
  }
  if (Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(normal).eigenvalues()[0] > kMinAxisSpread) {
    const Eigen::Vector3d center = normal.ldlt().solve(right);
    size_t ahead = 0;
    for (const Camera& c : cameras) ahead += c.Forward().dot(center - c.Center()) > 0 ? 1 : 0;
    if (2 * ahead > cameras.size()) return {center, MedianDistance(cameras, center)};
  }
  double reach = kFallbackReach * SpatialExtent(cameras);
  if (!(reach > 0)) reach = 1;  // one camera, or several in one place: any scale is as good
  return {eye + reach * forward, reach};
}

}  // namespace oraclegs
