#include "oraclegs/depth/pose_movement.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "oraclegs/camera/scene_bounds.h"
#include "oraclegs/depth/reprojection.h"

namespace oraclegs {
namespace {

constexpr int kReweightings = 10;
constexpr double kLeastMovement = 1e-6;  // radians and shares of the extent: less is as good as none

/// The rotation, scale and translation with the least weighted squares.
Similarity WeightedFit(const std::vector<Camera>& from, const std::vector<Camera>& to,
                       const std::vector<double>& weights) {
  double total = 0;
  Eigen::Vector3d mean_from(0, 0, 0), mean_to(0, 0, 0);
  Eigen::Matrix3d turns = Eigen::Matrix3d::Zero();
  for (size_t v = 0; v < from.size(); ++v) {
    total += weights[v];
    mean_from += weights[v] * from[v].Center();
    mean_to += weights[v] * to[v].Center();
    turns += weights[v] * (to[v].cam_from_world.linear().transpose() * from[v].cam_from_world.linear());
  }
  mean_from /= total;
  mean_to /= total;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(turns, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d sign = Eigen::Matrix3d::Identity();
  sign(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  Similarity fit;
  fit.rotation = svd.matrixU() * sign * svd.matrixV().transpose();
  double product = 0, square = 0;
  for (size_t v = 0; v < from.size(); ++v) {
    const Eigen::Vector3d a = fit.rotation * (from[v].Center() - mean_from), b = to[v].Center() - mean_to;
    product += weights[v] * a.dot(b);
    square += weights[v] * a.squaredNorm();
  }
  if (product > 0) fit.scale = product / square;
  fit.translation = mean_to - fit.scale * (fit.rotation * mean_from);
  return fit;
}

/// A camera's movement beside that of all, radians and world units of `to`.
Twist LeftOver(const Camera& from, const Camera& to, const Similarity& map) {
  Camera mapped = from;
  mapped.cam_from_world = Moved(from.cam_from_world, map);
  Twist left = TwistBetween(mapped, to);
  left.head<3>() = to.Center() - mapped.Center();
  return left;
}

}  // namespace

Similarity SimilarityBetween(const std::vector<Camera>& from, const std::vector<Camera>& to) {
  if (from.empty()) return {};
  const double extent = SpatialExtent(to);
  std::vector<double> weights(from.size(), 1);
  Similarity fit = WeightedFit(from, to, weights);
  // Least absolute instead of least squared movements: a few cameras that moved do not move the rest.
  for (int k = 0; k < kReweightings; ++k) {
    for (size_t v = 0; v < from.size(); ++v) {
      const Twist left = LeftOver(from[v], to[v], fit);
      const double shift = extent > 0 ? left.head<3>().norm() / extent : 0;
      weights[v] = 1 / std::max(kLeastMovement, std::hypot(shift, left.tail<3>().norm()));
    }
    fit = WeightedFit(from, to, weights);
  }
  return fit;
}

std::vector<Camera> Following(std::vector<Camera> others, const std::vector<Camera>& from,
                              const std::vector<Camera>& to) {
  const Similarity map = SimilarityBetween(from, to);
  for (Camera& camera : others) camera.cam_from_world = Moved(camera.cam_from_world, map);
  return others;
}

std::vector<CameraMovement> Movements(const std::vector<Camera>& from, const std::vector<Camera>& to) {
  const Similarity map = SimilarityBetween(from, to);
  const double extent = SpatialExtent(to);
  std::vector<CameraMovement> movements;
  for (size_t v = 0; v < from.size(); ++v) {
    const Twist left = LeftOver(from[v], to[v], map);
    movements.push_back({left.tail<3>().norm() * 180 / M_PI, extent > 0 ? left.head<3>().norm() / extent : 0});
  }
  return movements;
}

}  // namespace oraclegs
