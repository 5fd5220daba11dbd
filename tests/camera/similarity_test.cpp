#include "oraclegs/camera/similarity.h"

#include <gtest/gtest.h>

#include <cmath>

namespace oraclegs {
namespace {

Similarity Example() {
  return {Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 2) / 3).toRotationMatrix(), 2.5, {1, -2, 30}};
}

TEST(Similarity, IsUndoneByItsInverse) {
  const Similarity there = Example(), back = there.Inverse();
  const Eigen::Vector3d point(3, 4, -5);
  EXPECT_NEAR((back * (there * point) - point).norm(), 0, 1e-12);
  EXPECT_NEAR(((back * there) * point - point).norm(), 0, 1e-12);
  EXPECT_FALSE(there.IsIdentity());
  EXPECT_TRUE(Similarity().IsIdentity());
}

TEST(Moved, KeepsWhatACameraSees) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::AngleAxisd(1.1, Eigen::Vector3d::UnitX()).toRotationMatrix();
  pose.translation() = Eigen::Vector3d(0.5, 1, 4);
  const Similarity transform = Example();
  const Eigen::Vector3d point(0.3, -0.2, 1);
  const Eigen::Vector3d seen = pose * point, seen_then = Moved(pose, transform) * (transform * point);
  EXPECT_NEAR((seen_then - 2.5 * seen).norm(), 0, 1e-12);
}

TEST(Moved, KeepsTheBitsWhereNothingMoves) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::AngleAxisd(1.1, Eigen::Vector3d::UnitX()).toRotationMatrix();
  pose.translation() = Eigen::Vector3d(1e7 / 3, 1, 4);
  EXPECT_EQ(Moved(pose, {}).matrix(), pose.matrix());
}

TEST(Nudged, TurnsAboutTheCenterAndMovesAlongTheCamerasAxes) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::AngleAxisd(1.1, Eigen::Vector3d::UnitX()).toRotationMatrix();
  pose.translation() = Eigen::Vector3d(0.5, 1, 4);
  EXPECT_EQ(Nudged(pose, {0, 0, 0}, {0, 0, 0}).matrix(), pose.matrix());
  const Eigen::Vector3d center = pose.inverse().translation();
  EXPECT_NEAR((Nudged(pose, {0.3, -0.2, 0.1}, {0, 0, 0}).inverse().translation() - center).norm(), 0, 1e-12);
  // A quarter turn about the optical axis takes what is on the right to below.
  const Eigen::Vector3d seen = pose * Eigen::Vector3d(0.3, -0.2, 1);
  const Eigen::Vector3d then = Nudged(pose, {0, 0, std::acos(0.0)}, {1, 2, 3}) * Eigen::Vector3d(0.3, -0.2, 1);
  EXPECT_NEAR((then - Eigen::Vector3d(1 - seen.y(), 2 + seen.x(), 3 + seen.z())).norm(), 0, 1e-12);
}

}  // namespace
}  // namespace oraclegs
