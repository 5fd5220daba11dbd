#include "oraclegs/depth/reprojection.h"

#include <Eigen/Geometry>

namespace oraclegs {
namespace {

Eigen::Matrix3d CrossMatrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

Eigen::Matrix3d Turn(const Eigen::Vector3d& vector) {
  const double angle = vector.norm();
  if (!(angle > 0)) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, vector / angle).toRotationMatrix();
}

}  // namespace

Camera Stepped(const Camera& camera, const Twist& twist) {
  const Eigen::Matrix3d turn = Turn(twist.tail<3>());
  Camera moved = camera;
  // The quaternion keeps a rotation a rotation over many steps.
  moved.cam_from_world.linear() =
      Eigen::Quaterniond(Eigen::Matrix3d(turn * camera.cam_from_world.linear())).normalized().toRotationMatrix();
  moved.cam_from_world.translation() = turn * camera.cam_from_world.translation() + twist.head<3>();
  return moved;
}

Twist TwistBetween(const Camera& from, const Camera& to) {
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(to.cam_from_world.linear() * from.cam_from_world.linear().transpose()));
  Twist twist;
  twist << to.cam_from_world.translation() - turn * from.cam_from_world.translation(), turn.angle() * turn.axis();
  return twist;
}

std::optional<Reprojection> Reproject(const Camera& view, const Camera& other, const DeepPixel& pixel) {
  const Eigen::Matrix3d rotation =
      other.cam_from_world.linear() * view.cam_from_world.linear().transpose();  // to `other`, from `view`
  const Eigen::Vector3d translation = other.cam_from_world.translation() - rotation * view.cam_from_world.translation();
  const double w = pixel.inv_depth;
  const Eigen::Vector3d ray((pixel.u - view.cx) / view.fx, (pixel.v - view.cy) / view.fy, 1);
  // The point in the other camera's frame times w, so that a far point is as good as a near one.
  const Eigen::Vector3d y = rotation * ray + translation * w;
  if (!(y.z() > 0)) return std::nullopt;
  const double px = y.x() / y.z(), py = y.y() / y.z();
  Eigen::Matrix<double, 2, 3> by_point;
  by_point << other.fx, 0, -other.fx * px, 0, other.fy, -other.fy * py;
  by_point /= y.z();

  Reprojection result;
  result.at = Eigen::Vector2d(other.fx * px + other.cx, other.fy * py + other.cy);
  result.depth_ratio = y.z();
  result.by_view << -w * by_point * rotation, by_point * rotation * CrossMatrix(ray);
  result.by_other << w * by_point, -by_point * CrossMatrix(y);
  result.by_inv_depth = by_point * translation;
  return result;
}

}  // namespace oraclegs
