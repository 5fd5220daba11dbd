#include "oraclegs/sfm/homography.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "oraclegs/core/rng.h"

namespace oraclegs {
namespace {

Eigen::Matrix3d SomeMap() {
  Eigen::Matrix3d h;
  h << 1.1, .05, -20, -.04, .95, 12, 2e-4, -1e-4, 1;
  return h;
}

/// Points over an image of 320 x 240, seen with up to `noise` pixels of error.
std::vector<PointMatch> Matches(int count, double noise) {
  std::vector<PointMatch> matches;
  Rng rng(7, RandomStream::kInitialPoints);
  for (int i = 0; i < count; ++i) {
    const double x = rng.Uniform(0, 320), y = rng.Uniform(0, 240);
    const double dx = rng.Uniform(-noise, noise), dy = rng.Uniform(-noise, noise);
    const Eigen::Vector2d a(x, y);
    matches.push_back({a, (SomeMap() * a.homogeneous()).hnormalized() + Eigen::Vector2d(dx, dy)});
  }
  return matches;
}

double WorstError(const Eigen::Matrix3d& h) {
  double worst = 0;
  for (const PointMatch& exact : Matches(100, 0)) {
    worst = std::max(worst, ((h * exact.a.homogeneous()).hnormalized() - exact.b).norm());
  }
  return worst;
}

TEST(RefitHomography, ImprovesAMapOfFewNoisyPoints) {
  Eigen::Matrix3d start = SomeMap();
  start(0, 2) += 4;
  start(2, 0) += 2e-5;
  ASSERT_GT(WorstError(start), 3);
  EXPECT_LT(WorstError(RefitHomography(start, Matches(300, .5))), .2);
}

TEST(RefitHomography, IgnoresOutliers) {
  std::vector<PointMatch> matches = Matches(300, .3);
  for (size_t i = 0; i < matches.size(); i += 10) matches[i].b += Eigen::Vector2d(40, -25);
  EXPECT_LT(WorstError(RefitHomography(SomeMap(), matches)), .15);
}

TEST(RefitHomography, KeepsTheStartWithFewInliers) {
  EXPECT_EQ(RefitHomography(SomeMap(), {}), SomeMap());
  EXPECT_EQ(RefitHomography(SomeMap(), Matches(7, 0)), SomeMap());
}

TEST(RefitHomography, IsFiniteForCoincidentPoints) {
  EXPECT_TRUE(RefitHomography(SomeMap(), std::vector<PointMatch>(20, Matches(1, 0)[0])).allFinite());
}

Eigen::Matrix3d IntrinsicMatrix(double focal) {
  Eigen::Matrix3d k;
  k << focal, 0, 500, 0, focal, 400, 0, 0, 1;
  return k;
}

TEST(RotationResidual, IsSmallForAPureRotation) {
  const Eigen::Matrix3d rotation =
      (Eigen::AngleAxisd(.3, Eigen::Vector3d::UnitY()) * Eigen::AngleAxisd(.1, Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  for (const double focal : {600., 850., 1200., 2000.}) {
    const Eigen::Matrix3d map = IntrinsicMatrix(focal) * rotation * IntrinsicMatrix(focal).inverse();
    EXPECT_LT(RotationResidual(map, {1000, 800}, {1000, 800}), .012) << focal;
    EXPECT_NEAR(RotationResidual(-3 * map, {1000, 800}, {1000, 800}), RotationResidual(map, {1000, 800}, {1000, 800}),
                1e-9)
        << "a homography has no scale";
  }
}

TEST(RotationResidual, IsLargeForAStepAside) {
  const Eigen::Vector3d normal = Eigen::Vector3d(.1, 0, 1).normalized();
  for (const Eigen::Vector3d& step : {Eigen::Vector3d(.2, 0, 0), Eigen::Vector3d(0, 0, .2)}) {
    const Eigen::Matrix3d map = IntrinsicMatrix(900) * (Eigen::Matrix3d::Identity() + step * normal.transpose()) *
                                IntrinsicMatrix(900).inverse();
    EXPECT_GT(RotationResidual(map, {1000, 800}, {1000, 800}), .03);
  }
  EXPECT_TRUE(std::isinf(RotationResidual(Eigen::Matrix3d::Zero(), {10, 8}, {10, 8})));
}

}  // namespace
}  // namespace oraclegs
