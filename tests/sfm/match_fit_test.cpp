#include "oraclegs/sfm/match_fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "support/matched_ring.h"

namespace oraclegs {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::Lt;

const Intrinsics kSquare{CameraModel::kPinhole, 500, 500, {400, 400, 250, 250}};

/// Camera b stands `x` to the right of camera a, turned alike.
Motion ToTheRight(double x) {
  Motion motion{Eigen::Isometry3d::Identity(), std::abs(x)};
  motion.b_from_a.translation() = Eigen::Vector3d(-x, 0, 0);
  return motion;
}

std::vector<double> ErrorsOf(const std::vector<PointMatch>& matches, const Motion& motion) {
  std::vector<double> errors;
  AppendErrors(RaysOf({{0, 1, matches}}, {kSquare, kSquare}).front(), motion, &errors);
  return errors;
}

TEST(AppendErrors, MeasuresTheDistanceFromTheEpipolarLine) {
  // A point at depth 10 moves by 400 / 10 = 40 pixels to the left; anywhere on its line it fits.
  const auto on_line = ErrorsOf({{{250, 250}, {210, 250}}, {{300, 100}, {200, 100}}}, ToTheRight(1));
  EXPECT_THAT(on_line, Each(Lt(1e-9)));
  // 2 pixels above the line: shared by both images 2 / sqrt(2), of an image of twice the size twice that.
  const auto off = ErrorsOf({{{250, 250}, {246, 248}}}, ToTheRight(1));
  EXPECT_NEAR(off[0], 2 * 2 / std::sqrt(2.), .01);
}

TEST(AppendErrors, IsInfiniteBehindTheCameras) {
  EXPECT_THAT(ErrorsOf({{{210, 250}, {250, 250}}}, ToTheRight(1)), ElementsAre(INFINITY));
  EXPECT_THAT(ErrorsOf({{{250, 250}, {210, 250}}}, ToTheRight(-1)), ElementsAre(INFINITY));
  // Far points have no parallax: the sign of what little noise leaves says nothing.
  EXPECT_LT(ErrorsOf({{{250, 250}, {250.3, 250}}}, ToTheRight(1))[0], 1e-9);
}

TEST(AppendErrors, MeasuresTheAngleWithoutABaseline) {
  const auto errors =
      ErrorsOf({{{250, 250}, {250, 250}}, {{250, 250}, {253, 254}}}, {Eigen::Isometry3d::Identity(), 1});
  EXPECT_NEAR(errors[0], 0, 1e-9);
  EXPECT_NEAR(errors[1], 2 * 5, .01);
}

TEST(AppendErrors, DoesNotDependOnUnitAndOrigin) {
  const MatchedRing ring = MakeMatchedRing(4, 40);
  const auto rays = RaysOf(ring.pairs, ring.intrinsics);
  const auto errors_of = [&](double scale, const Eigen::Vector3d& origin) {
    std::vector<Eigen::Isometry3d> poses = ring.cams_from_world;
    for (Eigen::Isometry3d& pose : poses) {
      Eigen::Isometry3d world_from_cam = pose.inverse();
      world_from_cam.translation() = scale * world_from_cam.translation() + origin;
      pose = world_from_cam.inverse();
    }
    std::vector<double> errors;
    for (const RayPair& pair : rays) {
      AppendErrors(
          pair, MotionBetween(poses[static_cast<size_t>(pair.a)], poses[static_cast<size_t>(pair.b)], ExtentOf(poses)),
          &errors);
    }
    return errors;
  };
  const auto expected = errors_of(1, {0, 0, 0});
  EXPECT_THAT(expected, Each(Lt(1.)));
  for (const double scale : {1e-4, 1., 1e6}) {
    const auto errors = errors_of(scale, Eigen::Vector3d(4e6, -1e7, 3e6) * std::max(scale, 1.));
    for (size_t i = 0; i < errors.size(); ++i) ASSERT_NEAR(errors[i], expected[i], scale < 1 ? .05 : 1e-3) << scale;
  }
}

TEST(RaysOf, LeavesOutWhatNoRayFallsOn) {
  const Intrinsics bent{CameraModel::kSimpleRadial, 500, 500, {400, 250, 250, -.5}};  // turns back inside the image
  const auto rays = RaysOf({{0, 1, {{{250, 250}, {250, 250}}, {{499, 499}, {250, 250}}}}}, {bent, bent});
  EXPECT_EQ(rays.front().rays_a.size(), 1u);
  EXPECT_EQ(rays.front().rays_b.size(), 1u);
}

TEST(Thinned, TakesEvenly) {
  std::vector<PointMatch> matches;
  for (int i = 0; i < 10; ++i) matches.push_back({{i, 0}, {0, 0}});
  const auto thinned = Thinned({{0, 1, matches}}, 5);
  ASSERT_EQ(thinned[0].matches.size(), 5u);
  EXPECT_EQ(thinned[0].matches[4].a.x(), 8);
  EXPECT_EQ(Thinned({{0, 1, matches}}, 20)[0].matches.size(), 10u);
}

TEST(ShareBelow, CountsOnlyWhatIsBelow) {
  EXPECT_EQ(ShareBelow({1, 2, 3, INFINITY}, 3), .5);
  EXPECT_EQ(ShareBelow({}, 3), 0);
}

}  // namespace
}  // namespace oraclegs
