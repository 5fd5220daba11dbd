#pragma once
// Where and how large a scene is, by its cameras.

#include <Eigen/Core>
#include <vector>

#include "oraclegs/camera/camera.h"

namespace oraclegs {

struct Ball {
  Eigen::Vector3d center;  ///< world
  double radius;           ///< world units
};

/// Radius of the cameras' positions: 1.1 * max distance of a camera center from their mean ([Kerbl 2023],
/// docs/method.md#scene-extent); 0 without cameras.
double SpatialExtent(const std::vector<Camera>& cameras);

/// The ball that the cameras look at, scene units: around the point nearest to all optical axes, as far as the median
/// camera is from it, or, when the axes are parallel or meet behind the cameras, ahead of the mean camera. At least one
/// camera.
Ball LookedAt(const std::vector<Camera>& cameras);

}  // namespace oraclegs
