#include "oraclegs/camera/camera.h"

#include <cmath>

#include "oraclegs/core/error.h"

namespace oraclegs {
namespace {

constexpr double kRotationTolerance = 1e-4;

}  // namespace

void Camera::Check(const std::string& name) const {
  if (width <= 0 || height <= 0)
    throw InputError("{}: the image size is {} x {}, must be positive", name, width, height);
  if (!std::isfinite(fx) || !std::isfinite(fy) || !std::isfinite(cx) || !std::isfinite(cy)) {
    throw InputError("{}: the intrinsics fx {}, fy {}, cx {}, cy {} must be finite", name, fx, fy, cx, cy);
  }
  if (fx <= 0 || fy <= 0) throw InputError("{}: the focal length is {} x {} pixels, must be positive", name, fx, fy);
  const Eigen::Matrix3d rotation = cam_from_world.linear();
  if (!rotation.allFinite() || !cam_from_world.translation().allFinite()) {
    throw InputError("{}: the pose has a number that is not finite", name);
  }
  const double error = (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (error > kRotationTolerance || rotation.determinant() < 0) {
    throw InputError("{}: the pose is not a rotation (|R R' - I| = {:.3g}, determinant {:.3g})", name, error,
                     rotation.determinant());
  }
}

Camera Resized(const Camera& camera, int width, int height) {
  const double sx = static_cast<double>(width) / camera.width;
  const double sy = static_cast<double>(height) / camera.height;
  Camera resized = camera;
  resized.width = width;
  resized.height = height;
  resized.fx *= sx;
  resized.cx *= sx;
  resized.fy *= sy;
  resized.cy *= sy;
  return resized;
}

double TurnBetween(const Camera& a, const Camera& b) {
  // Angle from the chord between the rotations: the trace would lose half of the digits of a small angle.
  const double chord = (a.cam_from_world.linear() - b.cam_from_world.linear()).norm();
  return 2 * std::asin(std::min(1., chord / (2 * std::sqrt(2.))));
}

}  // namespace oraclegs
