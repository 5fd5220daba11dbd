#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>

namespace oraclegs {

/// One pinhole image's intrinsics and pose. Camera frame: x right, y down, z forward (COLMAP, OpenCV). Pixel (0,0)
/// covers [0,1) x [0,1), so its center is (0.5, 0.5). Lengths are in scene units.
struct Camera {
  int width = 0, height = 0;              ///< pixels
  double fx = 0, fy = 0, cx = 0, cy = 0;  ///< pixels; (cx, cy) from the image's top-left corner
  Eigen::Isometry3d cam_from_world = Eigen::Isometry3d::Identity();  ///< x_cam = R x_world + t

  Eigen::Vector3d Center() const { return -(cam_from_world.linear().transpose() * cam_from_world.translation()); }
  /// Unit vector along the optical axis, world frame.
  Eigen::Vector3d Forward() const { return cam_from_world.linear().row(2).transpose(); }

  /// Throws InputError "NAME: ..." when a number is not finite, a size or focal length is not positive, or the
  /// rotation is not one (|R R' - I| > 1e-4 or det < 0).
  void Check(const std::string& name) const;
};

/// A view on an image of another size, in pixels: intrinsics scale per axis.
Camera Resized(const Camera& camera, int width, int height);

/// Angle between the rotations of two cameras, radians.
double TurnBetween(const Camera& a, const Camera& b);

}  // namespace oraclegs
