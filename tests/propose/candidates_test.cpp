#include "oraclegs/propose/candidates.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "oraclegs/propose/nearest_order.h"
#include "oraclegs/propose/target_check.h"
#include "propose/rigs.h"

namespace oraclegs {
namespace {

using Eigen::Vector3d;

double ElevationDegrees(const Camera& c) { return std::asin(c.Center().normalized().z()) * 180 / std::numbers::pi; }

void ExpectValid(const std::vector<Camera>& cameras, const Camera& like) {
  for (const Camera& c : cameras) {
    EXPECT_NO_THROW(c.Check("candidate"));
    EXPECT_EQ(c.width, like.width);
    EXPECT_EQ(c.fy, like.fy);
    EXPECT_EQ(c.cx, like.cx);
  }
}

TEST(OrbitCandidates, MakesCirclesAtSeveralHeights) {
  const auto train = RigAround(12);
  const auto orbit = OrbitCandidates(train, 30);
  ASSERT_EQ(orbit.size(), 30u);
  ExpectValid(orbit, train[0]);
  std::vector<int> heights;
  for (const Camera& c : orbit) {
    EXPECT_NEAR(c.Center().norm(), 4, 1e-6);
    EXPECT_NEAR(c.Forward().dot(-c.Center().normalized()), 1, 1e-9);
    EXPECT_GT(ElevationDegrees(c), 10);
    EXPECT_LT(ElevationDegrees(c), 60);
    heights.push_back(static_cast<int>(std::lround(ElevationDegrees(c))));
  }
  std::sort(heights.begin(), heights.end());
  heights.erase(std::unique(heights.begin(), heights.end()), heights.end());
  EXPECT_EQ(heights.size(), 3u);
}

TEST(OrbitCandidates, MakesOneCircleForOneHeight) {
  std::vector<Camera> train;
  for (int i = 0; i < 6; ++i) {
    const double a = i * std::numbers::pi / 3;
    train.push_back(RigCamera({3 * std::cos(a), 3 * std::sin(a), 1}, {0, 0, 0}));
  }
  for (const Camera& c : OrbitCandidates(train, 10)) EXPECT_NEAR(c.Center().z(), 1, 1e-6);
}

TEST(OrbitCandidates, StaysOnArc) {
  const auto train = RigAround(6, 100);
  const auto orbit = OrbitCandidates(train, 40);
  ASSERT_EQ(orbit.size(), 40u);
  ExpectValid(orbit, train[0]);
  for (const Camera& c : orbit) {
    double nearest = 1e9;
    for (const Camera& t : train) nearest = std::min(nearest, (t.Center() - c.Center()).norm());
    EXPECT_LT(nearest, 1.5);
  }
  for (size_t i = 0; i < orbit.size(); ++i) {
    for (size_t j = 0; j < i; ++j) EXPECT_GT((orbit[i].Center() - orbit[j].Center()).norm(), 1e-3) << "there and back";
  }
}

TEST(SpiralCandidates, RisesAndFallsAroundScene) {
  const auto train = RigAround(12);
  const auto spiral = SpiralCandidates(train, 40);
  ASSERT_EQ(spiral.size(), 40u);
  ExpectValid(spiral, train[0]);
  EXPECT_LT(ElevationDegrees(spiral.front()), 15);
  EXPECT_GT(ElevationDegrees(spiral[20]), 45);  // the highest view is at 47.5
  EXPECT_LT(ElevationDegrees(spiral.back()), 15);
  for (size_t i = 0; i + 1 < spiral.size(); ++i) {
    EXPECT_LT((spiral[i].Center() - spiral[i + 1].Center()).norm(), 4 * 2 * std::numbers::pi * 2.382 / 40 * 1.2);
  }
}

TEST(SpiralCandidates, StaysOnArc) {
  const auto train = RigAround(8, 160);  // looks from far more than one side, not from all
  for (const Camera& c : SpiralCandidates(train, 30)) {
    const double azimuth = std::atan2(c.Center().y(), c.Center().x()) * 180 / std::numbers::pi;
    EXPECT_GT(azimuth, -1);
    EXPECT_LT(azimuth, 160 * 7 / 8. + 1);
  }
}

TEST(SpiralCandidates, CirclesMeanPoseOfForwardFacingViews) {
  const auto train = RigForward(9);
  const auto spiral = SpiralCandidates(train, 30);
  ASSERT_EQ(spiral.size(), 30u);
  ExpectValid(spiral, train[0]);
  for (const Camera& c : spiral) {
    EXPECT_GT(c.Forward().y(), 0.8);
    EXPECT_GT(c.Center().x(), -0.1);
    EXPECT_LT(c.Center().x(), 2.5);
  }
}

TEST(InterpolatedCandidates, IsEvenSmoothAndOffTrainingPoses) {
  const auto train = RigAround(10);
  for (const int count : {1, 9, 18, 50, 200}) {
    const auto path = InterpolatedCandidates(train, count);
    ASSERT_EQ(path.size(), static_cast<size_t>(count));
    ExpectValid(path, train[0]);
    const PoseSet views(train, SamePlace(train));
    double length = 0, longest = 0, turn = 0;
    for (size_t i = 0; i < path.size(); ++i) {
      EXPECT_FALSE(views.Has(path[i])) << i << " of " << count;
      if (i == 0) continue;
      const double step = (path[i].Center() - path[i - 1].Center()).norm();
      length += step, longest = std::max(longest, step);
      turn = std::max(turn, TurnBetween(path[i], path[i - 1]));
    }
    if (count < 50) continue;
    EXPECT_LT(longest, 1.4 * length / (count - 1));
    EXPECT_LT(turn, 4 * length / (count - 1) / 4 * 2);  // around an object 4 away, at most twice as fast as needed
  }
}

TEST(InterpolatedCandidates, SpacesPureRotationByAngle) {
  std::vector<Camera> train;
  for (const double a : {0., 0.2, 0.6}) train.push_back(RigCamera({0, 0, 0}, {std::cos(a), std::sin(a), 0}));
  const auto path = InterpolatedCandidates(train, 6);
  ASSERT_EQ(path.size(), 6u);
  for (size_t i = 0; i + 1 < path.size(); ++i) EXPECT_NEAR(TurnBetween(path[i], path[i + 1]), 0.1, 0.03);
}

TEST(JitteredCandidates, LieBetweenNeighbors) {
  const auto train = RigAround(8);
  const auto a = JitteredCandidates(train, 50, 7), b = JitteredCandidates(train, 50, 7);
  const auto other = JitteredCandidates(train, 50, 8);
  ASSERT_EQ(a.size(), 50u);
  ExpectValid(a, train[0]);
  for (size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].cam_from_world.matrix(), b[i].cam_from_world.matrix());
    EXPECT_LT(a[i].Center().norm(), 5.5);
  }
  EXPECT_NE(a[0].cam_from_world.matrix(), other[0].cam_from_world.matrix());
}

TEST(Candidates, AcceptFewCameras) {
  const auto one = RigAround(1);
  EXPECT_TRUE(OrbitCandidates(one, 5).empty());
  EXPECT_TRUE(SpiralCandidates(one, 5).empty());
  EXPECT_TRUE(InterpolatedCandidates(one, 5).empty());
  EXPECT_TRUE(JitteredCandidates(one, 5, 0).empty());
  for (const int n : {2, 3}) {
    for (const auto& train : {RigAround(n), RigAround(n, 60), RigForward(n)}) {
      for (const auto& cameras : {OrbitCandidates(train, 5), SpiralCandidates(train, 5),
                                  InterpolatedCandidates(train, 5), JitteredCandidates(train, 5, 0)}) {
        EXPECT_EQ(cameras.size(), 5u) << n;
        ExpectValid(cameras, train[0]);
      }
    }
  }
  const std::vector<Camera> twins(3, one[0]);  // three views from one place in one direction
  EXPECT_TRUE(OrbitCandidates(twins, 5).empty());
  EXPECT_TRUE(SpiralCandidates(twins, 5).empty());
  EXPECT_TRUE(InterpolatedCandidates(twins, 5).empty());
}

}  // namespace
}  // namespace oraclegs
