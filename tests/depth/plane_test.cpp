#include "oraclegs/depth/plane.h"

#include <gtest/gtest.h>

#include "depth/rig.h"

namespace oraclegs {
namespace {

const Camera kFrom = CameraAt({-0.6, 0.1, -4}, {0.1, 0, 0}), kTo = CameraAt({0.7, -0.2, -3.5}, {0, 0.1, 0.3});

Eigen::Vector3d Project(const Camera& camera, const Eigen::Vector3d& point) {
  const Eigen::Vector3d p = camera.cam_from_world * point;
  return {camera.fx * p.x() / p.z() + camera.cx, camera.fy * p.y() / p.z() + camera.cy, p.z()};
}

TEST(MapBetween, MapsPixelToProjection) {
  const Eigen::Vector3d point(0.2, -0.3, 0.4), a = Project(kFrom, point), b = Project(kTo, point);
  const Eigen::Vector3f q =
      MapBetween(kFrom, kTo)(static_cast<float>(a.x()), static_cast<float>(a.y()), static_cast<float>(1 / a.z()));
  EXPECT_NEAR(q.x() / q.z(), b.x(), 1e-3);
  EXPECT_NEAR(q.y() / q.z(), b.y(), 1e-3);
  EXPECT_NEAR(q.z() * a.z(), b.z(), 1e-4) << "the third coordinate is the ratio of depths";
}

TEST(Plain, EqualsEigenMap) {
  const PixelMap map = MapBetween(kFrom, kTo);
  const Eigen::Vector3f q = map(30.5f, 70.25f, 0.3f);
  const Vec3f p = Plain(map)(30.5f, 70.25f, 0.3f);
  EXPECT_EQ(Eigen::Vector3f(p.x, p.y, p.z), q);
}

TEST(Plane, IsLinearInInverseDepth) {
  const TexturedPlane surface{{0, 0, 0.5}, Eigen::Vector3d(0.4, -0.3, -1).normalized()};
  const auto inverse = [&](double u, double v) { return 1 / surface.DepthAt(kFrom, u, v); };
  const double u = 40.5, v = 70.5;
  const Plane plane{static_cast<float>(inverse(u, v)), static_cast<float>(inverse(u + 1, v) - inverse(u, v)),
                    static_cast<float>(inverse(u, v + 1) - inverse(u, v))};
  EXPECT_NEAR(plane.At(30, -20), inverse(u + 30, v - 20), 1e-5);
  const Eigen::Vector3f normal = NormalOf(kFrom, plane, static_cast<float>(u), static_cast<float>(v));
  const Eigen::Vector3d truth = kFrom.cam_from_world.linear() * surface.normal;
  EXPECT_GT(normal.cast<double>().dot(truth), 0.9999);
  EXPECT_LT(normal.dot(RayOf(kFrom, static_cast<float>(u), static_cast<float>(v))), 0) << "towards the camera";
}

}  // namespace
}  // namespace oraclegs
