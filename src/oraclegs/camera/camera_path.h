#pragma once
// Paths of a camera through a scene of which there are only a few views.

#include <vector>

#include "oraclegs/camera/camera.h"

namespace oraclegs {

/// A smooth closed path of `frames` poses with the intrinsics of the first camera, from the training cameras alone.
/// Views from all around (no gap of 120 degrees or more between neighbors, seen from the point nearest to all
/// optical axes): a circle around the axis of mean "up", at their mean height and distance, looking at that point.
/// Otherwise there and back through the poses in the order in which they lie beside each other, so that the path never
/// leaves what the views show. Throws std::invalid_argument without cameras or frames.
std::vector<Camera> OrbitPath(const std::vector<Camera>& cameras, int frames);

/// `frames` poses that rise from the lowest to the highest of the cameras, from the training cameras alone. Views from
/// all around: two turns of the circle of OrbitPath. Otherwise two turns of an ellipse in front of the scene, as wide
/// and high as half of what the cameras spread over, looking at the point nearest to their axes. Throws
/// std::invalid_argument without cameras or frames.
std::vector<Camera> SpiralPath(const std::vector<Camera>& cameras, int frames);

/// `frames` poses of the smooth path through the cameras in their order, from the first to the last, each with as much
/// time as any other; intrinsics of the first. Throws std::invalid_argument without cameras or frames.
std::vector<Camera> InterpolatedPath(const std::vector<Camera>& cameras, int frames);

/// A pose of the smooth path through the cameras in this order, at s in [0, order.size() - 1]: whole numbers are the
/// cameras themselves. Centers by cubic splines whose speed is limited, so that unevenly placed cameras make no loops;
/// rotations by slerp.
Eigen::Isometry3d PoseAlong(const std::vector<Camera>& cameras, const std::vector<size_t>& order, double s);

/// The order in which the cameras lie beside each other: around what they look at, beginning behind the widest gap, or,
/// when they do not look towards one point, along the direction in which they are spread most.
std::vector<size_t> OrderBesideEachOther(const std::vector<Camera>& cameras);

/// Cameras by azimuth around a point.
struct CameraRing {
  std::vector<size_t> order;  ///< by azimuth, beginning behind the widest gap
  double first_azimuth = 0;   ///< radians, of order[0], in GroundAxes
  double widest_gap = 0;      ///< radians, between neighbors
  bool all_around = false;    ///< all look towards the point and no gap is 120 degrees or more
};

/// At least one camera.
CameraRing RingAround(const std::vector<Camera>& cameras, const Eigen::Vector3d& focus, const Eigen::Vector3d& up);

/// Unit; the mean of where the images' upper sides point, z when they cancel out.
Eigen::Vector3d MeanUp(const std::vector<Camera>& cameras);

/// Two unit rows that make a right-handed frame with `up`. Azimuth is atan2(row 1, row 0).
Eigen::Matrix<double, 2, 3> GroundAxes(const Eigen::Vector3d& up);

/// The point with the least sum of squared distances to the cameras' optical axes; for parallel axes, where there is
/// none, the nearest to the mean camera center.
Eigen::Vector3d NearestToAxes(const std::vector<Camera>& cameras);

/// A camera pose at `center` that looks at `target` with `up` upwards in the image.
Eigen::Isometry3d LookAt(const Eigen::Vector3d& center, const Eigen::Vector3d& target, const Eigen::Vector3d& up);

}  // namespace oraclegs
