#include "oraclegs/sfm/match_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "oraclegs/camera/distortion_models.h"

namespace oraclegs {
namespace {

constexpr double kNoBaseline = 1e-6;     // of the extent
constexpr double kNoParallaxPixels = 3;  // the depth of rays that are nearer to parallel has no certain sign

double PixelsPerRadian(const Intrinsics& camera) {
  return std::sqrt(camera.fx() * camera.fy()) * kReferenceSide / std::max(camera.width, camera.height);
}

/// Whether the point lies in front of both cameras. `a` is turned into the frame of b already.
bool IsInFront(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& baseline,
               double no_parallax) {
  const double cosine = a.dot(b);
  if (a.cross(b).norm() < no_parallax) return cosine > 0;
  const double along_a = cosine * baseline.dot(b) - baseline.dot(a);
  const double along_b = baseline.dot(b) - cosine * baseline.dot(a);
  return along_a > 0 && along_b > 0;
}

}  // namespace

std::vector<RayPair> RaysOf(const std::vector<ViewPair>& pairs, const std::vector<Intrinsics>& intrinsics) {
  std::vector<DistortionMap> maps;
  for (const Intrinsics& camera : intrinsics) maps.emplace_back(camera);
  std::vector<RayPair> rays;
  for (const ViewPair& pair : pairs) {
    const auto a = static_cast<size_t>(pair.a), b = static_cast<size_t>(pair.b);
    RayPair out{pair.a, pair.b, {}, {}, std::sqrt(PixelsPerRadian(intrinsics[a]) * PixelsPerRadian(intrinsics[b]))};
    for (const PointMatch& match : pair.matches) {
      const auto in_a = maps[a].Unproject(match.a.x(), match.a.y());
      const auto in_b = maps[b].Unproject(match.b.x(), match.b.y());
      if (!in_a || !in_b) continue;
      out.rays_a.push_back(in_a->homogeneous().normalized());
      out.rays_b.push_back(in_b->homogeneous().normalized());
    }
    rays.push_back(std::move(out));
  }
  return rays;
}

std::vector<ViewPair> Thinned(const std::vector<ViewPair>& pairs, size_t limit) {
  std::vector<ViewPair> thinned = pairs;
  for (ViewPair& pair : thinned) {
    const size_t n = pair.matches.size();
    if (n <= limit) continue;
    for (size_t i = 0; i < limit; ++i) pair.matches[i] = pair.matches[i * n / limit];
    pair.matches.resize(limit);
  }
  return thinned;
}

void AppendErrors(const RayPair& pair, const Motion& motion, std::vector<double>* errors) {
  const Eigen::Matrix3d& rotation = motion.b_from_a.linear();
  const double baseline = motion.b_from_a.translation().norm();
  const bool stands_still = baseline <= kNoBaseline * motion.extent || baseline == 0;
  const Eigen::Vector3d direction =
      stands_still ? Eigen::Vector3d::Zero() : Eigen::Vector3d(motion.b_from_a.translation() / baseline);
  const double no_parallax = kNoParallaxPixels / pair.pixels_per_radian;
  for (size_t i = 0; i < pair.rays_a.size(); ++i) {
    const Eigen::Vector3d a = rotation * pair.rays_a[i];
    const Eigen::Vector3d& b = pair.rays_b[i];
    if (stands_still) {
      errors->push_back(std::atan2(a.cross(b).norm(), a.dot(b)) * pair.pixels_per_radian);
      continue;
    }
    if (!IsInFront(a, b, direction, no_parallax)) {
      errors->push_back(std::numeric_limits<double>::infinity());
      continue;
    }
    const double residual = std::abs(b.dot(direction.cross(a)));
    const double slope2 = direction.cross(a).squaredNorm() + direction.cross(b).squaredNorm();
    // A ray along the baseline has no epipolar line: every direction of the other camera fits it.
    errors->push_back(slope2 > 0 ? residual / std::sqrt(slope2) * pair.pixels_per_radian : 0);
  }
}

double ExtentOf(const std::vector<Eigen::Isometry3d>& cams_from_world) {
  double extent = 0;
  for (const Eigen::Isometry3d& a : cams_from_world) {
    for (const Eigen::Isometry3d& b : cams_from_world)
      extent = std::max(extent, MotionBetween(a, b, 0).b_from_a.translation().norm());
  }
  return extent;
}

Motion MotionBetween(const Eigen::Isometry3d& a_from_world, const Eigen::Isometry3d& b_from_world, double extent) {
  const Eigen::Matrix3d &a = a_from_world.linear(), &b = b_from_world.linear();
  Motion motion{Eigen::Isometry3d::Identity(), extent};
  motion.b_from_a.linear() = b * a.transpose();
  // The difference of the two centers, not t - R t, whose rounding grows far from the origin with what R lacks to a
  // rotation.
  const Eigen::Vector3d center_a = -(a.transpose() * a_from_world.translation());
  const Eigen::Vector3d center_b = -(b.transpose() * b_from_world.translation());
  motion.b_from_a.translation() = b * (center_a - center_b);
  return motion;
}

double ShareBelow(const std::vector<double>& errors, double limit) {
  if (errors.empty()) return 0;
  const auto below = std::count_if(errors.begin(), errors.end(), [&](double error) { return error < limit; });
  return static_cast<double>(below) / static_cast<double>(errors.size());
}

}  // namespace oraclegs
