#include "oraclegs/validate/picture_check.h"

#include <gtest/gtest.h>

#include "depth/surfaces.h"
#include "oraclegs/core/error.h"
#include "oraclegs/propose/warp.h"
#include "oraclegs/validate/tamper.h"

namespace oraclegs {
namespace {

/// Images of a textured plane, and their warp to a new pose.
class AgreementTest : public testing::Test {
 protected:
  AgreementTest() : views(TakeAll(plane, Arc(6, 8))) {
    for (const LoadedView& view : views) maps.push_back(TrueDepth(view, plane, 0.9f));
    warped = Warper({views, maps}).Warp(truth.camera);
  }

  TexturedPlane plane;
  std::vector<LoadedView> views;
  std::vector<DepthMap> maps;
  LoadedView truth = plane.Take(CameraAt({0.5, 0.1, -4}, {0, 0, 0}, 96, 72), "new");
  WarpedView warped;
};

TEST_F(AgreementTest, IsNearOneForWhatTheViewShows) { EXPECT_GT(Agreement(truth.rgb, warped).value(), 0.85); }

TEST_F(AgreementTest, IsSmallForPicturesThatAreWrongAsAWhole) {
  const ImageF constant{96, 72, 3, std::vector<float>(size_t{96} * 72 * 3, 0.4f)};
  EXPECT_EQ(Agreement(constant, warped).value(), 0);
  EXPECT_LT(Agreement(UpsideDown(truth.rgb), warped).value(), 0.25);
  EXPECT_LT(Agreement(Zoomed(truth.rgb, 1.4), warped).value(), 0.4);
  EXPECT_LT(Agreement(views[0].rgb, warped).value(), 0.55) << "smooth patches correlate by chance";
}

TEST_F(AgreementTest, StaysHighForAToneThatDiffers) {
  ImageF darker = truth.rgb;
  for (float& v : darker.data) v = 0.7f * v;
  EXPECT_GT(Agreement(darker, warped).value(), 0.85);
}

TEST_F(AgreementTest, IsUnknownWithoutTextureOrViews) {
  WarpedView nothing = warped;
  std::fill(nothing.rgb.data.begin(), nothing.rgb.data.end(), 0.5f);
  EXPECT_FALSE(Agreement(truth.rgb, nothing).has_value());
  nothing = warped;
  for (PixelEvidence& evidence : nothing.evidence) evidence.ring = 5;
  EXPECT_FALSE(Agreement(truth.rgb, nothing).has_value());
}

TEST_F(AgreementTest, RefusesAnotherSize) { EXPECT_THROW(Agreement(ImageF{1, 1, 3, {0, 0, 0}}, warped), ShapeError); }

TEST(PictureCheck, RejectsWhatAgreesLessThanRightPicturesDo) {
  PictureCheck check;
  EXPECT_FALSE(check.Rejects(0.0)) << "nothing is known of right pictures";
  check.Learn({0.8, 0.7, 0.9, 0.8}, {0.05, 0.1, 0.2, 0.1});
  EXPECT_TRUE(check.Rejects(0.2));
  EXPECT_FALSE(check.Rejects(0.8 * 0.45)) << "more than half is tampered with, but not all";
  EXPECT_FALSE(check.Rejects(std::nullopt));
  check.Learn({0.3, 0.3}, {});
  EXPECT_FALSE(check.Rejects(0.0));
}

TEST(PictureCheck, ForgivesWhereWrongPicturesLookRight) {
  PictureCheck check;
  check.Learn({0.9, 0.9}, {0.8, 0.9});
  EXPECT_FALSE(check.Rejects(0.5)) << "a scene that looks alike from everywhere";
}

}  // namespace
}  // namespace oraclegs
