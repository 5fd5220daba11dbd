#include "oraclegs/depth/pose_movement.h"

#include <gtest/gtest.h>

#include "depth/disturbed.h"
#include "depth/surfaces.h"

namespace oraclegs {
namespace {

Similarity SomeSimilarity() {
  return {Eigen::AngleAxisd(0.9, Eigen::Vector3d(2, -1, 2) / 3).toRotationMatrix(), 1.7, {4, -1, 2}};
}

std::vector<Camera> MovedBy(std::vector<Camera> cameras, const Similarity& map) {
  for (Camera& camera : cameras) camera.cam_from_world = Moved(camera.cam_from_world, map);
  return cameras;
}

void ExpectNear(const Similarity& found, const Similarity& expected) {
  EXPECT_NEAR((found.rotation - expected.rotation).norm(), 0, 1e-6);
  EXPECT_NEAR(found.scale, expected.scale, 1e-6);
  EXPECT_NEAR((found.translation - expected.translation).norm(), 0, 1e-5);
}

TEST(SimilarityBetween, FindsAChangeOfCoordinates) {
  for (const int n : {2, 3, 7}) {
    const std::vector<Camera> cameras = Arc(n, 15);
    ExpectNear(SimilarityBetween(cameras, MovedBy(cameras, SomeSimilarity())), SomeSimilarity());
  }
}

TEST(SimilarityBetween, IsNotMovedByACameraThatMoved) {
  const std::vector<Camera> cameras = Arc(6, 15);
  std::vector<Camera> moved = MovedBy(cameras, SomeSimilarity());
  Twist twist;
  twist << 0.2, 0, 0.1, 0.03, 0.02, 0;
  moved[2] = Stepped(moved[2], twist);
  ExpectNear(SimilarityBetween(cameras, moved), SomeSimilarity());
  const std::vector<CameraMovement> movements = Movements(cameras, moved);
  for (size_t v = 0; v < movements.size(); ++v) {
    EXPECT_NEAR(movements[v].degrees, v == 2 ? twist.tail<3>().norm() * 180 / M_PI : 0, 1e-4);
    EXPECT_NEAR(movements[v].share, v == 2 ? twist.head<3>().norm() / SpatialExtent(moved) : 0, 1e-5);
  }
}

TEST(SimilarityBetween, IsTheIdentityWhereNothingMoves) {
  EXPECT_TRUE(SimilarityBetween({}, {}).IsIdentity());
  const std::vector<Camera> one = Arc(1, 10), same{one[0], one[0], one[0]};
  for (const std::vector<Camera>& cameras : {one, same, Arc(4, 10)}) {
    ExpectNear(SimilarityBetween(cameras, cameras), {});
    for (const CameraMovement& movement : Movements(cameras, cameras)) {
      EXPECT_NEAR(movement.degrees, 0, 1e-5);
      EXPECT_NEAR(movement.share, 0, 1e-7);
    }
  }
}

TEST(Following, KeepsWhatOtherCamerasSeeOfTheScene) {
  const std::vector<Camera> cameras = Arc(4, 15), others = Arc(3, 7);
  const Similarity map = SomeSimilarity();
  const std::vector<Camera> follow = Following(others, cameras, MovedBy(cameras, map));
  const Eigen::Vector3d point(0.3, -0.2, 0.4);
  for (size_t v = 0; v < others.size(); ++v) {
    const Eigen::Vector3d before = others[v].cam_from_world * point, after = follow[v].cam_from_world * (map * point);
    EXPECT_NEAR((after - map.scale * before).norm(), 0, 1e-5);
    EXPECT_EQ(follow[v].fx, others[v].fx);
  }
}

}  // namespace
}  // namespace oraclegs
