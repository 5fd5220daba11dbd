#include "oraclegs/train/train_view.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "support/errors.h"
#include "train/small_scene.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;

TEST(ToTrainViewTest, CopiesPixelsAndMask) {
  LoadedView photo{"a", CameraOnCircle(0), {kWidth, kHeight, 3, std::vector<float>(kWidth * kHeight * 3, 0.25f)}, {}};
  photo.rgb.data[3 * (kWidth + 2) + 1] = 0.75f;  // row 1, column 2, green
  EXPECT_FALSE(ToTrainView(photo).pixel_weight.defined());
  photo.mask.assign(kWidth * kHeight, 1);
  photo.mask[5] = 0;
  const TrainView view = ToTrainView(photo);
  EXPECT_EQ(view.name, "a");
  EXPECT_EQ(view.image[(kWidth + 2) * 3 + 1], 0.75f);
  EXPECT_EQ(Wide(view.image).sum(), 0.25f * kWidth * kHeight * 3 + 0.5f);
  EXPECT_EQ(view.pixel_weight[5], 0);
  EXPECT_EQ(Wide(view.pixel_weight).sum(), kWidth * kHeight - 1);
  EXPECT_FALSE(view.alpha.defined());
  photo.mask.pop_back();
  EXPECT_THROW(ToTrainView(photo), ShapeError);
}

TEST(ToTrainViewTest, WeighsSoftEdges) {
  LoadedView photo{"a", CameraOnCircle(0), {kWidth, kHeight, 3, std::vector<float>(kWidth * kHeight * 3, 0.25f)}, {}};
  photo.mask.assign(kWidth * kHeight, 1);
  photo.weights.assign(kWidth * kHeight, 1);
  photo.weights[5] = 0.75f;
  EXPECT_EQ(ToTrainView(photo).pixel_weight[5], 0.75f);
  photo.weights.pop_back();
  EXPECT_THROW(ToTrainView(photo), ShapeError);
}

TEST(ToTrainViewTest, CopiesAlpha) {
  LoadedView photo{"a", CameraOnCircle(0), {kWidth, kHeight, 3, std::vector<float>(kWidth * kHeight * 3, 0.25f)}, {}};
  photo.alpha.assign(kWidth * kHeight, 1);
  photo.alpha[kWidth + 2] = 0.5f;
  const TrainView view = ToTrainView(photo);
  EXPECT_EQ(view.alpha[kWidth + 2], 0.5f);
  EXPECT_EQ(Wide(view.alpha).sum(), kWidth * kHeight - 0.5f);
  photo.alpha.push_back(1);
  EXPECT_THROW(ToTrainView(photo), ShapeError);
}

TrainView WithDepth(float inv_depth) {
  TrainView view{"a", CameraOnCircle(0), RandomUniform({kHeight, kWidth, 3}, 111), {}};
  view.inv_depth = Buffer<float>::Full({kHeight, kWidth}, inv_depth);
  view.depth_mask = Buffer<float>::Full({kHeight, kWidth}, 1.f);
  return view;
}

TEST(CheckViewsTest, RefusesDepthThatDoesNotFit) {
  EXPECT_NO_THROW(CheckViews({WithDepth(0.5f)}));
  TrainView view = WithDepth(0.5f);
  view.depth_mask = Buffer<float>();
  EXPECT_THROW(CheckViews({view}), ShapeError);
  view = WithDepth(0.5f);
  view.inv_depth = Buffer<float>();
  EXPECT_THROW(CheckViews({view}), ShapeError);
  view = WithDepth(0.5f);
  view.depth_mask = Buffer<float>::Full({kHeight, kWidth + 1}, 1.f);
  EXPECT_THROW(CheckViews({view}), ShapeError);
}

TEST(CheckViewsTest, NamesTheInverseDepthThatIsNotFinite) {
  TrainView view = WithDepth(0.5f);
  view.inv_depth[3 * kWidth + 7] = std::nanf("");
  try {
    CheckViews({view});
    ADD_FAILURE() << "a depth that is not a number was accepted";
  } catch (const ShapeError& e) {
    EXPECT_THAT(e.what(), HasSubstr("inv_depth of a is nan at column 7, row 3"));
  }
  view.depth_mask[3 * kWidth + 7] = 0;
  EXPECT_NO_THROW(CheckViews({view}));
}

TEST(CheckViewsTest, AlphaIsAShareOfEveryPixel) {
  TrainView view = Photos(1)[0];
  view.alpha = Buffer<float>::Full({kHeight, kWidth}, 1.f);
  EXPECT_NO_THROW(CheckViews({view}));
  for (const float wrong : {-0.1f, 1.1f, std::nanf("")}) {
    view.alpha[2 * kWidth + 4] = wrong;
    try {
      CheckViews({view});
      ADD_FAILURE() << wrong << " was accepted";
    } catch (const ShapeError& e) {
      EXPECT_THAT(e.what(), HasSubstr("at column 4, row 2, must be in 0 .. 1"));
    }
  }
  view.alpha = Buffer<float>::Full({kHeight, kWidth + 1}, 1.f);
  EXPECT_THROW(CheckViews({view}), ShapeError);
}

TEST(CheckProposalsTest, ConfidenceIsAShare) {
  EXPECT_NO_THROW(CheckProposals({}));
  TrainView view = WithDepth(0.5f);
  EXPECT_NO_THROW(CheckProposals({view}));
  view.pixel_weight = RandomUniform({kHeight, kWidth}, 112);
  EXPECT_NO_THROW(CheckProposals({view}));
  for (const float wrong : {1.5f, -0.5f, std::nanf("")}) {
    view.pixel_weight[3 * kWidth + 7] = wrong;
    try {
      CheckProposals({view});
      ADD_FAILURE() << "a confidence of " << wrong << " was accepted";
    } catch (const ShapeError& e) {
      EXPECT_THAT(e.what(), HasSubstr("confidence of a is " + fmt::format("{}", wrong) + " at column 7, row 3"));
    }
  }
  view.pixel_weight = Buffer<float>::Full({kHeight, kWidth - 1}, 1.f);
  EXPECT_THROW(CheckProposals({view}), ShapeError);
}

TEST(WithConfidencePowerTest, KeepsWhatHasNoConfidenceAtZero) {
  TrainView view = WithDepth(0.5f);
  EXPECT_FALSE(WithConfidencePower(view, 2).pixel_weight.defined());
  view.pixel_weight = Buffer<float>::Zeros({kHeight, kWidth});
  view.pixel_weight[1] = 0.25f;
  view.pixel_weight[2] = 0.5f;
  view.pixel_weight[3] = 1.f;
  const Buffer<float> before = view.pixel_weight.Clone();
  const auto row = [&](double power) {
    const Buffer<float> u = WithConfidencePower(view, power).pixel_weight;
    return std::vector<float>(u.data(), u.data() + 4);
  };
  EXPECT_TRUE(Equal(WithConfidencePower(view, 1).pixel_weight, before));
  EXPECT_EQ(row(2), (std::vector<float>{0, 0.0625f, 0.25f, 1}));
  EXPECT_EQ(row(0), (std::vector<float>{0, 1, 1, 1}));  // what has no confidence never counts
  EXPECT_TRUE(Equal(view.pixel_weight, before));        // not written
}

TEST(WithCleanDepthTest, DepthCountsOnlyWhereThePhotoDoes) {
  TrainView view = WithDepth(0.5f);
  view.inv_depth[3 * kWidth + 7] = std::nanf("");
  view.depth_mask[3 * kWidth + 7] = 0;
  view.depth_mask[4 * kWidth + 8] = 0.25f;
  view.pixel_weight = Buffer<float>::Full({kHeight, kWidth}, 1.f);
  view.pixel_weight.Rows(5, 6).SetZero();
  const TrainView clean = WithCleanDepth(view);
  EXPECT_EQ(clean.inv_depth[3 * kWidth + 7], 0);
  EXPECT_EQ(clean.depth_mask[4 * kWidth + 8], 0.25f);
  EXPECT_EQ(MaxAbs(clean.depth_mask.Rows(5, 6)), 0);
  EXPECT_EQ(Wide(clean.depth_mask).sum(), kHeight * kWidth - kWidth - 1.75f);
  EXPECT_EQ(Flat(view.depth_mask.Rows(5, 6)).minCoeff(), 1);  // not written
  view.pixel_weight.SetZero();
  EXPECT_FALSE(WithCleanDepth(view).inv_depth.defined());
  EXPECT_FALSE(WithCleanDepth(view).depth_mask.defined());
}

TEST(CamerasTest, AreInTheOrderOfTheViews) {
  EXPECT_TRUE(Cameras({}).empty());
  const auto views = Photos(3);
  const std::vector<Camera> cameras = Cameras(views);
  ASSERT_EQ(cameras.size(), 3u);
  for (size_t v = 0; v < 3; ++v) {
    EXPECT_EQ(cameras[v].cam_from_world.matrix(), views[v].camera.cam_from_world.matrix());
  }
}

TEST(CharacteristicDepthTest, IsTheMedianOfTheViewsMedians) {
  EXPECT_EQ(CharacteristicDepth({}), 0);
  TrainView none{"b", CameraOnCircle(0), RandomUniform({kHeight, kWidth, 3}, 113), {}};
  EXPECT_EQ(CharacteristicDepth({none}), 0);
  TrainView near = WithDepth(0.5f), far = WithDepth(0.125f), farther = WithDepth(0.0625f);
  EXPECT_EQ(CharacteristicDepth({near}), 2);
  EXPECT_EQ(CharacteristicDepth({near, none, far, farther}), 8);
  Flat(far.inv_depth.Rows(0, kHeight / 2 + 2)).setConstant(0.25f);  // most pixels
  EXPECT_EQ(CharacteristicDepth({near, far, farther}), 4);
  far.depth_mask.Rows(0, kHeight / 2 + 2).SetZero();  // which do not count
  EXPECT_EQ(CharacteristicDepth({near, far, farther}), 8);
}

TEST(CheckViews, RejectPlanesThatStandTwice) {
  TrainView view{"photo", CameraOnCircle(0), {}, {}};
  view.image_bytes = Buffer<uint8_t>::Full({kHeight, kWidth, 3}, 9);
  EXPECT_NO_THROW(CheckViews({view}));
  view.image = view.Image();
  EXPECT_THAT(MessageOf<ShapeError>([&] { CheckViews({view}); }), testing::HasSubstr("image of photo stand twice"));
  view.image = {};
  view.weight_bytes = Buffer<uint8_t>::Full({kHeight, kWidth + 1}, 9);
  EXPECT_THROW(CheckViews({view}), ShapeError);
}

TEST(ToTrainView, ShowsTheImageOfItsOwner) {
  auto photo = std::make_shared<LoadedView>();
  photo->camera = CameraOnCircle(0);
  photo->rgb = {kWidth, kHeight, 3, std::vector<float>(3 * kWidth * kHeight, 0.25f)};
  EXPECT_EQ(ToTrainView(*photo, photo).image.data(), photo->rgb.data.data());
  EXPECT_NE(ToTrainView(*photo).image.data(), photo->rgb.data.data());
}

}  // namespace
}  // namespace oraclegs
