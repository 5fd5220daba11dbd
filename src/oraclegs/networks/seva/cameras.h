#pragma once
// Cameras as SEVA sees them (docs/method.md#seva-cameras): intrinsics as fractions of the image size, a scene of
// standard size, and rays.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "oraclegs/networks/common/tensor.h"

namespace oraclegs::seva {

/// View of a frame. Camera axes: x right, y down, z forward.
struct View {
  Eigen::Isometry3d world_from_camera = Eigen::Isometry3d::Identity();
  Eigen::Matrix3d intrinsics = Eigen::Matrix3d::Identity();  ///< row 0 in widths, row 1 in heights of the image

  Eigen::Vector3d center() const { return world_from_camera.translation(); }
};

/// Angle between two rotations, degrees.
double RotationDegrees(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b);

/// Middle of a scene: the mean of the camera centers that lie within ten times the 97 % quantile of the distances to
/// their (lower) median.
struct SceneMiddle {
  Eigen::Vector3d median = Eigen::Vector3d::Zero();
  double quantile = 0;
  std::vector<bool> valid;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
};
/// Needs at least one center (ShapeError).
SceneMiddle FindSceneMiddle(const std::vector<Eigen::Vector3d>& centers);

/// Distance of a chunk's first camera from the scene's middle that SEVA was trained with.
inline constexpr double kCameraScale = 2;

/// Moves `chunk` so that the middle of `all` (the input images and targets of the scene) is the origin, and scales it
/// so that its first frame is kCameraScale away; where that frame is at the origin, the scale is kCameraScale.
/// Rotations stay. Throws ShapeError when either is empty.
std::vector<View> NormalizedViews(const std::vector<View>& chunk, const std::vector<View>& all);

/// Rays of every pixel in the frame of the first view, as Pluecker coordinates: [T, 6, height, width] float32,
/// channels 0-2 the unit direction, 3-5 origin x direction.
Tensor PlueckerMaps(const std::vector<View>& views, int64_t height, int64_t width);

}  // namespace oraclegs::seva
