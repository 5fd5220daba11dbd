#include "oraclegs/depth/reprojection.h"

#include <gtest/gtest.h>

#include "depth/disturbed.h"
#include "depth/rig.h"

namespace oraclegs {
namespace {

constexpr double kStep = 1e-6;

class ReprojectionTest : public testing::Test {
 protected:
  Camera view = CameraAt({-0.7, 0.2, -4}, {0, 0.1, 0}), other = CameraAt({0.9, -0.3, -3.5}, {0.1, 0, 0});
  DeepPixel pixel{50.5, 80.5, 0.27};
};

TEST_F(ReprojectionTest, IsWhereTheOtherCameraSeesThePoint) {
  const Eigen::Vector3d ray((pixel.u - view.cx) / view.fx, (pixel.v - view.cy) / view.fy, 1);
  const Eigen::Vector3d point = other.cam_from_world * (view.cam_from_world.inverse() * (ray / pixel.inv_depth));
  const auto seen = Reproject(view, other, pixel);
  ASSERT_TRUE(seen);
  EXPECT_NEAR(seen->at.x(), other.fx * point.x() / point.z() + other.cx, 1e-9);
  EXPECT_NEAR(seen->at.y(), other.fy * point.y() / point.z() + other.cy, 1e-9);
  EXPECT_NEAR(seen->depth_ratio, point.z() * pixel.inv_depth, 1e-12);
}

TEST_F(ReprojectionTest, HasTheDerivativesOfCentralDifferences) {
  const auto seen = Reproject(view, other, pixel);
  ASSERT_TRUE(seen);
  const auto expect_near = [](const Eigen::Vector2d& derivative, const Eigen::Vector2d& ahead,
                              const Eigen::Vector2d& behind) {
    EXPECT_NEAR((derivative - (ahead - behind) / (2 * kStep)).norm(), 0, 1e-6 * std::max(1.0, derivative.norm()));
  };
  for (int k = 0; k < 6; ++k) {
    const Twist step = kStep * Twist::Unit(k);
    expect_near(seen->by_view.col(k), Reproject(Stepped(view, step), other, pixel)->at,
                Reproject(Stepped(view, -step), other, pixel)->at);
    expect_near(seen->by_other.col(k), Reproject(view, Stepped(other, step), pixel)->at,
                Reproject(view, Stepped(other, -step), pixel)->at);
  }
  const auto at_depth = [&](double inv_depth) { return Reproject(view, other, {pixel.u, pixel.v, inv_depth})->at; };
  expect_near(seen->by_inv_depth, at_depth(pixel.inv_depth + kStep), at_depth(pixel.inv_depth - kStep));
}

TEST_F(ReprojectionTest, IsNothingBehindTheOtherCamera) {
  const Camera back = CameraAt({0, 0, 0}, {0, 0, 4});
  EXPECT_FALSE(Reproject(view, back, pixel));
}

TEST_F(ReprojectionTest, ReachesPointsAtInfinity) {
  const auto seen = Reproject(view, view, {pixel.u, pixel.v, 0});
  ASSERT_TRUE(seen);
  EXPECT_NEAR((seen->at - Eigen::Vector2d(pixel.u, pixel.v)).norm(), 0, 1e-9);
}

TEST_F(ReprojectionTest, TwistBetweenIsWhatStepsFromOneToTheOther) {
  const Camera there = Stepped(view, TwistBetween(view, other));
  EXPECT_NEAR((there.cam_from_world.matrix() - other.cam_from_world.matrix()).norm(), 0, 1e-12);
  EXPECT_NEAR(TwistBetween(view, view).norm(), 0, 1e-12);
}

}  // namespace
}  // namespace oraclegs
