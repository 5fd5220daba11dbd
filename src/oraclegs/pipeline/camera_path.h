#pragma once
// Where a camera can fly through a scene that only a few photographs have seen.

#include <vector>

#include "oraclegs/scene/camera.h"

namespace oraclegs {

/// A smooth closed path of `frames` poses with the intrinsics of the first camera, from the training cameras alone.
/// Photographs taken all around (no gap of 120 degrees or more between neighbours, seen from the point nearest to all
/// optical axes): a circle around the axis of mean "up", at their mean height and distance, looking at that point.
/// Otherwise there and back through the poses in the order in which they lie beside each other, so that the path never
/// leaves what was photographed. Throws std::invalid_argument without cameras or frames.
std::vector<Camera> OrbitPath(const std::vector<Camera>& cameras, int frames);

/// The point with the least sum of squared distances to the cameras' optical axes; for parallel axes, where there is
/// none, the nearest to the mean camera centre.
Eigen::Vector3d NearestToAxes(const std::vector<Camera>& cameras);

/// A camera pose at `center` that looks at `target` with `up` upwards in the image.
Eigen::Isometry3d LookAt(const Eigen::Vector3d& center, const Eigen::Vector3d& target, const Eigen::Vector3d& up);

}  // namespace oraclegs
