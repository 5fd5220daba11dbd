#include "oraclegs/sfm/pose_mistakes.h"

#include <gtest/gtest.h>

#include "support/matched_ring.h"

namespace oraclegs {
namespace {

Eigen::Matrix3d Signed(double x, double y, double z) { return Eigen::Vector3d(x, y, z).asDiagonal(); }

GivenCameras Given() {
  const MatchedRing ring = MakeMatchedRing(6, 40);
  return {ring.intrinsics, ring.cams_from_world, ring.pairs, 2};
}

TEST(BestAxes, KeepsWhatFits) {
  const ChangeFit best = BestAxes(Given());
  EXPECT_EQ(best.change.axes, Eigen::Matrix3d::Identity());
  EXPECT_FALSE(best.change.inverse);
  EXPECT_GT(best.share, .99);
}

TEST(BestAxes, FindsEachChange) {
  Eigen::Matrix3d quarter, cyclic;
  quarter << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  cyclic << 0, 0, 1, -1, 0, 0, 0, 1, 0;
  for (const Eigen::Matrix3d& axes : {Signed(1, 1, 1), Signed(1, -1, -1), Signed(-1, -1, 1), Signed(-1, 1, 1),
                                      Signed(1, -1, 1), Signed(1, 1, -1), quarter, cyclic}) {
    for (const bool inverse : {false, true}) {
      GivenCameras given = Given();
      given.cams_from_world = Changed(given.cams_from_world, {axes.transpose(), false});
      if (inverse) given.cams_from_world = Changed(given.cams_from_world, {Signed(1, 1, 1), true});
      const ChangeFit best = BestAxes(given);
      EXPECT_GT(best.share, .99) << axes;
      EXPECT_EQ(best.change.axes, axes);
      EXPECT_EQ(best.change.inverse, inverse) << axes;
    }
  }
}

TEST(BestAxes, TakesThePrincipalPointAlongWithThePixels) {
  for (const Eigen::Matrix3d& axes : {Signed(-1, 1, 1), Signed(1, -1, 1), Signed(-1, -1, 1)}) {
    const CameraChange of_pixels{axes, false, 1, false, true};
    GivenCameras given = Given();
    for (ViewPair& pair : given.pairs) {
      for (PointMatch& match : pair.matches)
        for (Eigen::Vector2d* pixel : {&match.a, &match.b}) *pixel += Eigen::Vector2d(60, 40);
    }
    for (Intrinsics& camera : given.intrinsics) {
      camera.params[2] += 60, camera.params[3] += 40;
      camera = Changed(camera, of_pixels);
    }
    given.cams_from_world = Changed(given.cams_from_world, of_pixels);
    const ChangeFit best = BestAxes(given);
    EXPECT_GT(best.share, .95) << axes;
    EXPECT_EQ(best.change.axes, axes);
    EXPECT_TRUE(best.change.is_of_pixels);
  }
}

TEST(BestAxes, FindsInversesThatWereMovedSince) {
  const Eigen::Translation3d moved(1.5, -.7, 4);
  GivenCameras given = Given();
  given.cams_from_world = Changed(given.cams_from_world, {Signed(1, 1, 1), true});
  for (Eigen::Isometry3d& pose : given.cams_from_world) pose = pose * moved;
  given.origin = -moved.translation();
  const ChangeFit best = BestAxes(given);
  EXPECT_GT(best.share, .99);
  EXPECT_TRUE(best.change.inverse);
  EXPECT_EQ(best.change.axes, Signed(1, 1, 1));
}

TEST(BestFocal, FindsTheFactor) {
  for (const double factor : {.5, .9, 1.3, 2., 3.}) {
    for (const bool is_other_resolution : {false, true}) {
      GivenCameras given = Given();
      for (Intrinsics& camera : given.intrinsics)
        camera = Changed(camera, {Signed(1, 1, 1), false, 1 / factor, is_other_resolution});
      const ChangeFit best = BestFocal(given);
      EXPECT_NEAR(best.change.focal_factor / factor, 1, .02) << factor << is_other_resolution;
      EXPECT_EQ(best.change.is_other_resolution, is_other_resolution) << factor;
      EXPECT_GT(best.share, .95) << factor << is_other_resolution;
    }
  }
}

TEST(Changed, ScalesTheCameraOfAnotherResolution) {
  const Intrinsics camera{CameraModel::kSimpleRadial, 100, 80, {90, 50, 40, .1}};
  const Intrinsics other = Changed(camera, {Signed(1, 1, 1), false, 2, true});
  EXPECT_EQ(other.fx(), 180);
  EXPECT_EQ(other.cx(), 100);
  EXPECT_EQ(other.cy(), 80);
  EXPECT_EQ(Changed(camera, {Signed(1, 1, 1), false, 2, false}).cx(), 50);
  EXPECT_EQ(other.params[4], .1) << "what bends rays does not depend on the resolution";
}

}  // namespace
}  // namespace oraclegs
