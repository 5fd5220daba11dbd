#include "oraclegs/camera/camera_path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace oraclegs {
namespace {

using Eigen::Vector3d;

Camera CameraAt(const Vector3d& center, const Vector3d& target) {
  Camera camera{.width = 64, .height = 48, .fx = 50, .fy = 50, .cx = 32, .cy = 24, .cam_from_world = {}};
  camera.cam_from_world = LookAt(center, target, Vector3d::UnitZ());
  return camera;
}

std::vector<Camera> Arc(int n, double from_deg, double to_deg, const Vector3d& focus) {
  std::vector<Camera> cameras;
  for (int i = 0; i < n; ++i) {
    const double a = (from_deg + (to_deg - from_deg) * i / n) * std::numbers::pi / 180;
    cameras.push_back(CameraAt(focus + Vector3d(4 * std::cos(a), 4 * std::sin(a), 1.5), focus));
  }
  return cameras;
}

TEST(LookAt, PutsTheTargetOnTheAxis) {
  const Eigen::Isometry3d pose = LookAt({1, 2, 3}, {4, 2, 3}, Vector3d::UnitZ());
  EXPECT_NEAR(pose.linear().determinant(), 1, 1e-12);
  EXPECT_TRUE((pose * Vector3d(4, 2, 3)).isApprox(Vector3d(0, 0, 3), 1e-12));
  EXPECT_LT((pose * Vector3d(4, 2, 3.5)).y(), 0);  // y points down
  EXPECT_NEAR(LookAt({0, 0, 5}, {0, 0, 0}, Vector3d::UnitZ()).linear().determinant(), 1, 1e-12);
}

TEST(NearestToAxes, FindsWhereAllAxesMeet) {
  const Vector3d focus(0.3, -2, 5);
  EXPECT_TRUE(NearestToAxes(Arc(5, 0, 70, focus)).isApprox(focus, 1e-9));
}

TEST(NearestToAxes, StaysAtTheCamerasForParallelAxes) {
  const std::vector<Camera> cameras = {CameraAt({0, 0, 0}, {0, 9, 0}), CameraAt({2, 0, 0}, {2, 9, 0})};
  EXPECT_TRUE(NearestToAxes(cameras).isApprox(Vector3d(1, 0, 0), 1e-9));
}

TEST(OrbitPath, CirclesViewsFromAllAround) {
  const Vector3d focus(1, 2, 3);
  const auto path = OrbitPath(Arc(9, 0, 360, focus), 30);
  ASSERT_EQ(path.size(), 30u);
  for (const Camera& c : path) {
    EXPECT_NO_THROW(c.Check("orbit"));
    EXPECT_NEAR((c.Center() - focus).norm(), std::hypot(4, 1.5), 1e-6);
    EXPECT_NEAR(c.Center().z(), 4.5, 1e-6);
    EXPECT_NEAR(c.Forward().dot((focus - c.Center()).normalized()), 1, 1e-9);
  }
  EXPECT_NEAR((path[0].Center() - path[15].Center()).norm(), 8, 1e-6);
}

TEST(OrbitPath, StaysOnTheArcOfTheViews) {
  const Vector3d focus(0, 0, 0);
  auto cameras = Arc(6, 0, 120, focus);
  std::swap(cameras[1], cameras[4]);  // the order of the views does not matter
  const auto path = OrbitPath(cameras, 50);
  for (const Camera& c : path) {
    EXPECT_NO_THROW(c.Check("orbit"));
    const double azimuth = std::atan2(c.Center().y(), c.Center().x()) * 180 / std::numbers::pi;
    EXPECT_GT(azimuth, -1);
    EXPECT_LT(azimuth, 101);
    EXPECT_NEAR(c.Center().norm(), std::hypot(4, 1.5), 0.15);
  }
  // It comes back to where it began, and turns round at the far end.
  EXPECT_TRUE(path[1].Center().isApprox(path[49].Center(), 1e-9));
  EXPECT_NEAR(std::atan2(path[25].Center().y(), path[25].Center().x()) * 180 / std::numbers::pi, 100, 1e-6);
}

TEST(OrbitPath, FollowsParallelCameras) {
  std::vector<Camera> cameras;
  for (const double x : {2.0, 0.0, 3.0, 1.0}) cameras.push_back(CameraAt({x, 0, 0}, {x, 9, 0}));
  const auto path = OrbitPath(cameras, 20);
  for (const Camera& c : path) {
    EXPECT_TRUE(c.Forward().isApprox(Vector3d::UnitY(), 1e-9));
    EXPECT_GE(c.Center().x(), -1e-9);
    EXPECT_LE(c.Center().x(), 3 + 1e-9);
  }
  EXPECT_NEAR(std::abs(path[0].Center().x() - path[10].Center().x()), 3, 1e-9);
}

TEST(OrbitPath, StaysAtASingleCamera) {
  const auto cameras = Arc(1, 30, 40, Vector3d::Zero());
  for (const Camera& c : OrbitPath(cameras, 3)) EXPECT_TRUE(c.Center().isApprox(cameras[0].Center(), 1e-12));
}

TEST(PoseAlong, PassesTheCamerasWithoutLoops) {
  std::vector<Camera> cameras;  // a short step after long ones: Catmull-Rom would run back there
  for (const double x : {0.0, 10.0, 10.2, 20.0}) cameras.push_back(CameraAt({x, 0, 0}, {x, 9, 0}));
  const std::vector<size_t> order = {0, 1, 2, 3};
  double before = -1e-9;
  for (int i = 0; i <= 300; ++i) {
    const Eigen::Isometry3d pose = PoseAlong(cameras, order, i / 100.);
    const double x = pose.inverse().translation().x();
    EXPECT_GE(x, before - 1e-9) << i;
    before = x;
  }
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_TRUE(PoseAlong(cameras, order, static_cast<double>(i)).isApprox(cameras[i].cam_from_world, 1e-12));
  }
}

TEST(RingAround, FindsTheWidestGap) {
  const Vector3d focus(1, 0, 2), up = Vector3d::UnitZ();
  auto cameras = Arc(8, 0, 360, focus);
  EXPECT_TRUE(RingAround(cameras, focus, up).all_around);
  EXPECT_NEAR(RingAround(cameras, focus, up).widest_gap, std::numbers::pi / 4, 1e-9);
  cameras[3].cam_from_world = LookAt(cameras[3].Center(), 2 * cameras[3].Center() - focus, up);
  EXPECT_FALSE(RingAround(cameras, focus, up).all_around);
  const CameraRing arc = RingAround(Arc(4, 30, 110, focus), focus, up);
  EXPECT_FALSE(arc.all_around);
  EXPECT_EQ(arc.order, (std::vector<size_t>{0, 1, 2, 3}));
  const Eigen::Vector2d first = GroundAxes(up) * (Arc(4, 30, 110, focus)[0].Center() - focus);
  EXPECT_NEAR(arc.first_azimuth, std::atan2(first.y(), first.x()), 1e-12);
}

TEST(MeanUp, PointsUpInTheImages) { EXPECT_TRUE(MeanUp(Arc(6, 0, 360, {0, 0, 0})).isApprox(Vector3d::UnitZ(), 1e-9)); }

TEST(OrbitPath, RefusesNoCamerasAndNoFrames) {
  EXPECT_THROW(OrbitPath({}, 3), std::invalid_argument);
  EXPECT_THROW(OrbitPath(Arc(2, 0, 9, Vector3d::Zero()), 0), std::invalid_argument);
}

TEST(SpiralPath, RisesInTwoTurnsAroundViewsFromAllAround) {
  const Vector3d focus(1, 2, 3);
  auto cameras = Arc(9, 0, 360, focus);
  cameras[2] = CameraAt(cameras[2].Center() + Vector3d(0, 0, 1), focus);
  const Vector3d up = MeanUp(cameras);
  const auto path = SpiralPath(cameras, 40);
  ASSERT_EQ(path.size(), 40u);
  for (size_t i = 0; i < path.size(); ++i) {
    EXPECT_NO_THROW(path[i].Check("spiral"));
    EXPECT_NEAR(path[i].Forward().dot((focus - path[i].Center()).normalized()), 1, 1e-3);
    if (i == 0) continue;
    EXPECT_GT(up.dot(path[i].Center()), up.dot(path[i - 1].Center()));
  }
  const auto beside = [&](size_t i) { return Vector3d(path[i].Center() - focus).head<2>().eval(); };
  EXPECT_NEAR((beside(0) - beside(20)).norm(), 0, 0.2);  // a turn later
  EXPECT_NEAR((beside(0) - beside(10)).norm(), 8, 0.3);  // half a turn later
}

TEST(SpiralPath, StaysBeforeViewsFromOneSide) {
  const Vector3d focus(0, 0, 0);
  const auto cameras = Arc(6, 0, 60, focus);
  const auto path = SpiralPath(cameras, 30);
  for (const Camera& c : path) {
    EXPECT_NO_THROW(c.Check("spiral"));
    const double azimuth = std::atan2(c.Center().y(), c.Center().x()) * 180 / std::numbers::pi;
    EXPECT_GT(azimuth, -1);
    EXPECT_LT(azimuth, 51);
    EXPECT_NEAR(c.Forward().dot((focus - c.Center()).normalized()), 1, 1e-9);
  }
  EXPECT_EQ(SpiralPath({cameras[0]}, 2).size(), 2u);
  EXPECT_THROW(SpiralPath({}, 2), std::invalid_argument);
}

TEST(InterpolatedPath, PassesTheCamerasInTheirOrder) {
  auto cameras = Arc(4, 0, 120, {0, 0, 0});
  std::swap(cameras[1], cameras[2]);
  const auto path = InterpolatedPath(cameras, 31);
  ASSERT_EQ(path.size(), 31u);
  for (size_t k = 0; k < 4; ++k) {
    EXPECT_TRUE(path[10 * k].cam_from_world.isApprox(cameras[k].cam_from_world, 1e-6)) << k;
  }
  for (const Camera& c : path) EXPECT_NO_THROW(c.Check("interpolated"));
  EXPECT_TRUE(InterpolatedPath({cameras[1]}, 3)[2].cam_from_world.isApprox(cameras[1].cam_from_world, 1e-9));
  EXPECT_EQ(InterpolatedPath(cameras, 1).size(), 1u);
  EXPECT_THROW(InterpolatedPath({}, 3), std::invalid_argument);
}

}  // namespace
}  // namespace oraclegs
