#include "oraclegs/propose/target_check.h"

#include <gtest/gtest.h>

#include "propose/rigs.h"

namespace oraclegs {
namespace {

using Eigen::Vector3d;

TEST(SamePlace, IsThousandthOfNeighborDistance) {
  std::vector<Camera> cameras;
  for (const double x : {0., 1., 3.}) cameras.push_back(RigCamera({x, 0, 0}, {x, 9, 0}));
  EXPECT_NEAR(SamePlace(cameras), 1e-3 * 4 / 3, 1e-12);
  EXPECT_GT(SamePlace({cameras[0]}), 0);
  EXPECT_LT(SamePlace({cameras[0]}), 1e-6);
}

TEST(PoseSet, ComparesCenterAndRotation) {
  const PoseSet set({RigCamera({1, 2, 3}, {0, 0, 0})}, 0.01);
  EXPECT_TRUE(set.Has(RigCamera({1, 2, 3}, {0, 0, 0})));
  EXPECT_TRUE(set.Has(RigCamera({1.005, 2, 3}, {0.005, 0, 0})));
  EXPECT_FALSE(set.Has(RigCamera({1.02, 2, 3}, {0.02, 0, 0})));
  EXPECT_FALSE(set.Has(RigCamera({1, 2, 3}, {0.05, 0, 0})));
  EXPECT_FALSE(PoseSet({}, 1).Has(RigCamera({1, 2, 3}, {0, 0, 0})));
}

TEST(EvenSample, SamplesEvenly) {
  const auto points = SpherePoints(1000, 1);
  EXPECT_EQ(EvenSample(points, 5000).size(), 1000u);
  const auto sample = EvenSample(points, 100);
  ASSERT_EQ(sample.size(), 100u);
  for (size_t i = 0; i < 100; ++i) EXPECT_EQ(sample[i].xyz, points[10 * i].xyz);
}

TEST(PointsSeen, SkipsBackfacingOutsideAndOccluded) {
  const Camera camera = RigCamera({0, -4, 0}, {0, 0, 0});
  const Eigen::Vector3f towards(0, -1, 0), none(0, 0, 0);
  std::vector<DensePoint> points(6);
  points[0] = {{0, 0, 0}, towards, none};
  points[1] = {{0.5f, 0, 0}, -towards, none};  // its back
  points[2] = {{0, -5, 0}, none, none};        // behind the camera
  points[3] = {{30, 0, 0}, none, none};        // beside the image
  points[4] = {{0, 3, 0}, none, none};         // behind the first
  points[5] = {{0, 0.1f, 0}, none, none};      // of the same surface
  EXPECT_EQ(PointsSeen(points, camera), (std::vector<int>{0, 5}));
}

class TargetCheckTest : public ::testing::Test {
 protected:
  TargetCheckTest() : points_(SpherePoints(5000, 1)) {
    request_.train = RigAround(12);
    request_.test = {RigCamera({3, 3, 1}, {0, 0, 0})};
    request_.points = &points_;
  }
  Verdict Classify(const Vector3d& center, const Vector3d& target) {
    return TargetCheck(request_).Classify(RigCamera(center, target));
  }

  std::vector<DensePoint> points_;
  TrajectoryRequest request_;
};

TEST_F(TargetCheckTest, ClassifiesPoses) {
  EXPECT_EQ(Classify({0, -4, 1}, {0, 0, 0}), Verdict::kGood);
  EXPECT_EQ(Classify({3, 3, 1}, {0, 0, 0}), Verdict::kTestPose);
  EXPECT_EQ(TargetCheck(request_).Classify(request_.train[3]), Verdict::kKnownPose);
  EXPECT_EQ(Classify({0, -1.1, 0}, {0, 0, 0}), Verdict::kInsideGeometry);
  EXPECT_EQ(Classify({0, -4, 1}, {0, -9, 1}), Verdict::kSeesNothing);
}

TEST_F(TargetCheckTest, UsesDepthMaps) {
  std::vector<DepthMap> maps;
  for (const Camera& camera : request_.train) {
    const size_t pixels = static_cast<size_t>(camera.width) * static_cast<size_t>(camera.height);
    maps.push_back({"view", camera, std::vector<float>(pixels, 1 / 8.f), {}, std::vector<float>(pixels, 1.f)});
  }
  EXPECT_EQ(Classify({0, -2.5, 0}, {0, 0, 0}), Verdict::kGood);
  request_.maps = &maps;
  EXPECT_EQ(Classify({0, -2.5, 0}, {0, 0, 0}), Verdict::kInsideGeometry);  // 1.5 from the sphere, a quarter of 8 is 2
}

TEST_F(TargetCheckTest, IgnoresFewNearPoints) {
  for (int i = 0; i < 4; ++i) points_.push_back({{0, -4, 1.1f}, {0, 0, 0}, {0, 0, 0}});
  EXPECT_EQ(Classify({0, -4, 1}, {0, 0, 0}), Verdict::kGood);
  points_.push_back(points_.back());
  EXPECT_EQ(Classify({0, -4, 1}, {0, 0, 0}), Verdict::kInsideGeometry);
}

TEST_F(TargetCheckTest, AllowsDistanceOfTrainingViews) {
  request_.train.push_back(RigCamera({0, -1.2, 0}, {0, 0, 0}));  // 0.2 from the surface
  EXPECT_EQ(Classify({0.1, -1.25, 0}, {0, 0, 0}), Verdict::kGood);
}

TEST_F(TargetCheckTest, AcceptsSmallObjects) {
  points_ = SpherePoints(5000, 0.2);  // on 2 % of the grid
  EXPECT_EQ(Classify({0, -4, 1}, {0, 0, 0}), Verdict::kGood);
  EXPECT_EQ(Classify({0, -4, 1}, {9, 0, 0}), Verdict::kSeesNothing);
}

TEST_F(TargetCheckTest, ChecksOnlyPosesWithoutPoints) {
  points_.resize(99);
  EXPECT_EQ(Classify({0, -0.5, 0}, {0, 0, 9}), Verdict::kGood);
  EXPECT_EQ(Classify({3, 3, 1}, {0, 0, 0}), Verdict::kTestPose);
  EXPECT_TRUE(TargetCheck(request_).points().empty());
}

}  // namespace
}  // namespace oraclegs
