#pragma once
// Cameras that are a little wrong.

#include <cmath>
#include <vector>

#include "oraclegs/camera/scene_bounds.h"
#include "oraclegs/core/rng.h"
#include "oraclegs/depth/pose_movement.h"
#include "oraclegs/depth/reprojection.h"

namespace oraclegs {

/// Each camera turned by `degrees` and moved by a `share` of the scene extent, in directions drawn with the seed.
inline std::vector<Camera> Disturbed(std::vector<Camera> cameras, double degrees, double share, uint64_t seed) {
  Rng rng(seed, RandomStream::kTargets);
  const auto direction = [&] {
    const double z = rng.Uniform(-1, 1), angle = rng.Uniform(0, 2 * M_PI), r = std::sqrt(1 - z * z);
    return Eigen::Vector3d(r * std::cos(angle), r * std::sin(angle), z);
  };
  const double extent = SpatialExtent(cameras);
  for (Camera& camera : cameras) {
    Twist twist;
    twist << share * extent * direction(), degrees * M_PI / 180 * direction();
    camera = Stepped(camera, twist);
  }
  return cameras;
}

/// Mean movement of cameras against each other.
inline CameraMovement MeanMovement(const std::vector<Camera>& from, const std::vector<Camera>& to) {
  CameraMovement mean;
  for (const CameraMovement& movement : Movements(from, to)) {
    mean.degrees += movement.degrees / static_cast<double>(from.size());
    mean.share += movement.share / static_cast<double>(from.size());
  }
  return mean;
}

}  // namespace oraclegs
