#include "oraclegs/sfm/two_motions.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "oraclegs/core/rng.h"

namespace oraclegs {
namespace {

constexpr double kFocal = 1000, kSide = 1500;

double Random(uint64_t i, uint64_t of) { return Philox::Draw(5, of, i).Uniform(); }

/// A point of a room (x, y within 1, z between 2 and 6).
Eigen::Vector3d RoomPoint(uint64_t i) { return {2 * Random(i, 1) - 1, 2 * Random(i, 2) - 1, 2 + 4 * Random(i, 3)}; }

Eigen::Vector2d PixelOf(const Eigen::Vector3d& point) {
  return kFocal * point.hnormalized() + Eigen::Vector2d(kSide / 2, kSide / 2);
}

Eigen::Isometry3d Moved(double radians, const Eigen::Vector3d& step) {
  Eigen::Isometry3d pose(Eigen::AngleAxisd(radians, Eigen::Vector3d::UnitY()));
  pose.translation() = step;
  return pose;
}

/// `count` points of a room, seen before and after the motion.
std::vector<PointMatch> Seen(const Eigen::Isometry3d& motion, int count, uint64_t first = 0) {
  std::vector<PointMatch> matches;
  for (uint64_t i = first; matches.size() < static_cast<size_t>(count); ++i) {
    const Eigen::Vector3d point = RoomPoint(i);
    const Eigen::Vector2d noise(.4 * Random(i, 4) - .2, .4 * Random(i, 5) - .2);
    matches.push_back({PixelOf(point), PixelOf(motion * point) + noise});
  }
  return matches;
}

std::vector<PointMatch> Chance(int count) {
  std::vector<PointMatch> matches;
  for (uint64_t i = 0; i < static_cast<uint64_t>(count); ++i) {
    matches.push_back({{kSide * Random(i, 6), kSide * Random(i, 7)}, {kSide * Random(i, 8), kSide * Random(i, 9)}});
  }
  return matches;
}

std::vector<PointMatch> Still(int count) {
  std::vector<PointMatch> matches = Chance(count);
  for (PointMatch& match : matches) match.b = match.a + Eigen::Vector2d(.3, -.4);
  return matches;
}

const Eigen::Isometry3d kStep = Moved(.1, {-.6, .1, .1});

TEST(CountMotions, SeesOneMotion) {
  const MotionCounts counts = CountMotions({Seen(kStep, 300), Chance(200), std::nullopt, kSide});
  EXPECT_EQ(counts.inliers, 300);
  EXPECT_GT(counts.moving, 250);
  EXPECT_FALSE(counts.HasStillPart());
  EXPECT_FALSE(counts.HasMovedPart());
  EXPECT_FALSE(counts.IsPlanar());
}

TEST(CountMotions, ToleratesACircleAroundAPoint) {
  // Turns about what it looks at: points near that do not move in the image.
  const Eigen::Isometry3d circle =
      Moved(.05, Eigen::Vector3d(0, 0, 4) - Moved(.05, {0, 0, 0}) * Eigen::Vector3d(0, 0, 4));
  const MotionCounts counts = CountMotions({Seen(circle, 3000), {}, std::nullopt, kSide});
  EXPECT_GE(counts.still, 12);
  EXPECT_FALSE(counts.HasStillPart());
}

TEST(CountMotions, SeesABackgroundThatStandsStill) {
  std::vector<PointMatch> outliers = Chance(60);
  for (const PointMatch& match : Still(40)) outliers.push_back(match);
  EXPECT_TRUE(CountMotions({Seen(kStep, 100), outliers, std::nullopt, kSide}).HasStillPart());
  std::vector<PointMatch> inliers = Seen(kStep, 40);  // a motion that explains both
  for (const PointMatch& match : Still(100)) inliers.push_back(match);
  EXPECT_TRUE(CountMotions({inliers, Chance(60), std::nullopt, kSide}).HasStillPart());
  EXPECT_FALSE(CountMotions({Still(100), Chance(60), std::nullopt, kSide}).HasStillPart()) << "nothing moves at all";
}

TEST(CountMotions, SeesAThingThatMoved) {
  std::vector<PointMatch> outliers = Chance(60);
  for (uint64_t i = 0; i < 50; ++i) {  // a thing of a fifth of the room, turned and moved
    const Eigen::Vector3d point = .2 * RoomPoint(i + 7000) + Eigen::Vector3d(.3, .2, 3);
    outliers.push_back({PixelOf(point), PixelOf(kStep * (Moved(.1, {.2, -.5, 0}) * point))});
  }
  const MotionCounts counts = CountMotions({Seen(kStep, 300), outliers, std::nullopt, kSide});
  EXPECT_GE(counts.apart, 30);
  EXPECT_TRUE(counts.HasMovedPart());
}

TEST(CountMotions, SeesAPlane) {
  const Eigen::Matrix3d map = (Eigen::Matrix3d() << 1.1, .02, 40, -.01, 1.05, -30, 1e-5, 2e-5, 1).finished();
  std::vector<PointMatch> plane = Chance(200);
  for (PointMatch& match : plane) match.b = (map * match.a.homogeneous()).hnormalized();
  EXPECT_TRUE(CountMotions({plane, {}, map, kSide}).IsPlanar());
  for (const PointMatch& match : Seen(kStep, 30)) plane.push_back(match);
  EXPECT_FALSE(CountMotions({plane, {}, map, kSide}).IsPlanar()) << "an eighth lies elsewhere";
}

}  // namespace
}  // namespace oraclegs
