#include "oraclegs/depth/plane.h"

#include <Eigen/LU>

namespace oraclegs {
namespace {

Eigen::Matrix3d IntrinsicMatrix(const Camera& c) {
  Eigen::Matrix3d k;
  k << c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1;
  return k;
}

}  // namespace

PixelMap MapBetween(const Camera& from, const Camera& to) {
  const Eigen::Isometry3d to_from = to.cam_from_world * from.cam_from_world.inverse();
  const Eigen::Matrix3d k = IntrinsicMatrix(to);
  return {(k * to_from.linear() * IntrinsicMatrix(from).inverse()).cast<float>(),
          (k * to_from.translation()).cast<float>()};
}

PlainPixelMap Plain(const PixelMap& map) {
  const auto column = [](const Eigen::Vector3f& v) { return Vec3f{v.x(), v.y(), v.z()}; };
  return {column(map.rotation.col(0)), column(map.rotation.col(1)), column(map.rotation.col(2)),
          column(map.translation)};
}

Eigen::Vector3f NormalOf(const Camera& camera, const Plane& plane, float u, float v) {
  // n'X = d means 1/z = (n/d)' K^-1 (u, v, 1), hence n/d = K' (dx, dy, inverse depth at the pixel (0, 0)'s corner).
  const float at_axis = plane.At(static_cast<float>(camera.cx) - u, static_cast<float>(camera.cy) - v);
  const Eigen::Vector3f away(plane.dx * static_cast<float>(camera.fx), plane.dy * static_cast<float>(camera.fy),
                             at_axis);
  return -away.normalized();
}

}  // namespace oraclegs
