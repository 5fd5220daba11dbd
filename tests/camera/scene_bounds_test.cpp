#include "oraclegs/camera/scene_bounds.h"

#include <gtest/gtest.h>

#include <cmath>

namespace oraclegs {
namespace {

Camera LookAt(const Eigen::Vector3d& eye, const Eigen::Vector3d& target) {
  Camera camera;
  const Eigen::Vector3d z = (target - eye).normalized();
  const Eigen::Vector3d x = Eigen::Vector3d(0.1, -1, 0.05).cross(z).normalized();
  Eigen::Matrix3d r;
  r << x.transpose(), z.cross(x).transpose(), z.transpose();
  camera.cam_from_world.linear() = r;
  camera.cam_from_world.translation() = -(r * eye);
  return camera;
}

/// n cameras on a circle of this radius, `height` above the center they look at.
std::vector<Camera> Ring(int n, double radius, double height, const Eigen::Vector3d& center) {
  std::vector<Camera> cameras;
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * M_PI * i / n;
    const Eigen::Vector3d eye = center + Eigen::Vector3d(radius * std::cos(angle), height, radius * std::sin(angle));
    cameras.push_back(LookAt(eye, center));
  }
  return cameras;
}

TEST(SpatialExtent, ScalesTheLargestDistanceFromTheMean) {
  EXPECT_NEAR(SpatialExtent(Ring(8, 2, 0.6, {5, 6, 7})), 1.1 * 2, 1e-9);
  EXPECT_EQ(SpatialExtent({}), 0);
  const std::vector<Camera> pair = {LookAt({0, 0, 0}, {0, 0, 1}), LookAt({4, 0, 0}, {4, 0, 1})};
  EXPECT_NEAR(SpatialExtent(pair), 2.2, 1e-9);
}

TEST(LookedAt, IsTheCenterOfARing) {
  const Eigen::Vector3d center(10, -3, 4);
  const Ball ball = LookedAt(Ring(7, 3, 4, center));
  EXPECT_LT((ball.center - center).norm(), 1e-9);
  EXPECT_NEAR(ball.radius, 5, 1e-9);
}

TEST(LookedAt, TakesTheMedianDistanceAsRadius) {
  std::vector<Camera> cameras = Ring(5, 2, 0, {0, 0, 0});
  cameras.push_back(LookAt({90, 0, 0}, {0, 0, 0}));
  EXPECT_NEAR(LookedAt(cameras).radius, 2, 1e-9);
}

TEST(LookedAt, LiesAheadOfParallelAxes) {
  std::vector<Camera> cameras;
  for (int i = 0; i < 5; ++i) cameras.push_back(LookAt({0.2 * i, 0, 1}, {0.2 * i, 0, 9}));
  const Ball ball = LookedAt(cameras);
  const double reach = 3 * SpatialExtent(cameras);
  EXPECT_LT((ball.center - Eigen::Vector3d(0.4, 0, 1 + reach)).norm(), 1e-9);
  EXPECT_NEAR(ball.radius, reach, 1e-9);
}

TEST(LookedAt, LiesAheadWhenAxesMeetBehindTheCameras) {
  std::vector<Camera> outward;  // a bundle that spreads from (0, 0, -5)
  for (const Camera& c : Ring(6, 1, 0, {0, 0, 0})) {
    const Eigen::Vector3d eye(c.Center().x(), c.Center().z(), 0);
    outward.push_back(LookAt(eye, eye + (eye - Eigen::Vector3d(0, 0, -5))));
  }
  EXPECT_GT(LookedAt(outward).center.z(), 1);
}

TEST(LookedAt, LiesAUnitAheadOfASingleCamera) {
  const Ball ball = LookedAt({LookAt({1, 2, 3}, {1, 2, 9})});
  EXPECT_LT((ball.center - Eigen::Vector3d(1, 2, 4)).norm(), 1e-9);
  EXPECT_EQ(ball.radius, 1);
}

}  // namespace
}  // namespace oraclegs
