#include "oraclegs/scene/colmap_model.h"

#include <cmath>

#include "oraclegs/core/error.h"

namespace oraclegs {

Eigen::Isometry3d PoseFromQuaternion(const std::array<double, 4>& wxyz, const Eigen::Vector3d& translation,
                                     const std::string& file, const std::string& image) {
  constexpr double kSmallestNorm = 1e-9;  // below it the direction is rounding noise
  const Eigen::Quaterniond q(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
  if (!q.coeffs().allFinite() || !translation.allFinite()) {
    throw InputError("{}: the pose of image '{}' is not finite; remove the image from the model or register it again",
                     file, image);
  }
  const double norm = q.coeffs().stableNorm();
  if (!(norm > kSmallestNorm) || !std::isfinite(norm)) {
    throw InputError(
        "{}: the rotation of image '{}' is not one (its quaternion has length {}); register the image again", file,
        image, norm);
  }
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::Quaterniond(q.coeffs() / norm).normalized().toRotationMatrix();
  pose.translation() = translation;
  return pose;
}

}  // namespace oraclegs
