#include "oraclegs/camera/similarity.h"

namespace oraclegs {

Similarity Similarity::operator*(const Similarity& first) const {
  return {rotation * first.rotation, scale * first.scale, *this * first.translation};
}

Similarity Similarity::Inverse() const {
  Similarity inverse;
  inverse.rotation = rotation.transpose();
  inverse.scale = 1 / scale;
  inverse.translation = -(inverse.rotation * translation) / scale;
  return inverse;
}

bool Similarity::IsIdentity() const { return rotation.isIdentity(0) && scale == 1 && translation.isZero(0); }

Eigen::Isometry3d Moved(const Eigen::Isometry3d& cam_from_world, const Similarity& transform) {
  if (transform.IsIdentity()) return cam_from_world;  // the bits stay as they are
  const Eigen::Vector3d center = -(cam_from_world.linear().transpose() * cam_from_world.translation());
  Eigen::Isometry3d moved = Eigen::Isometry3d::Identity();
  moved.linear() = cam_from_world.linear() * transform.rotation.transpose();
  moved.translation() = -(moved.linear() * (transform * center));
  return moved;
}

Eigen::Isometry3d Nudged(const Eigen::Isometry3d& cam_from_world, const Eigen::Vector3d& turn,
                         const Eigen::Vector3d& shift) {
  const double angle = turn.norm();
  Eigen::Isometry3d step = Eigen::Isometry3d::Identity();
  if (angle > 0) step.linear() = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
  step.translation() = shift;
  return step * cam_from_world;
}

}  // namespace oraclegs
