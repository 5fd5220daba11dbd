#include "oraclegs/train/train_view.h"

#include <cmath>

#include "support/golden.h"
#include "train/small_scene.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;

TEST(ToTrainViewTest, CopiesPixelsAndMask) {
  Photo photo{"a", CameraOnCircle(0), {kWidth, kHeight, 3, std::vector<float>(kWidth * kHeight * 3, 0.25f)}, {}};
  photo.rgb.data[3 * (kWidth + 2) + 1] = 0.75f;  // row 1, column 2, green
  EXPECT_FALSE(ToTrainView(photo).confidence.defined());
  photo.mask.assign(kWidth * kHeight, 1);
  photo.mask[5] = 0;
  const TrainView view = ToTrainView(photo);
  EXPECT_EQ(view.name, "a");
  EXPECT_EQ(view.image[1][2][1].item<float>(), 0.75f);
  EXPECT_EQ(view.image.sum().item<float>(), 0.25f * kWidth * kHeight * 3 + 0.5f);
  EXPECT_EQ(view.confidence[0][5].item<float>(), 0);
  EXPECT_EQ(view.confidence.sum().item<float>(), kWidth * kHeight - 1);
  photo.mask.pop_back();
  EXPECT_THROW(ToTrainView(photo), ShapeError);
}

TrainView WithDepth(float inv_depth) {
  TrainView view{"a", CameraOnCircle(0), torch::rand({kHeight, kWidth, 3}), {}};
  view.inv_depth = torch::full({kHeight, kWidth}, inv_depth);
  view.depth_mask = torch::ones({kHeight, kWidth});
  return view;
}

TEST(CheckViewsTest, RefusesDepthThatDoesNotFit) {
  EXPECT_NO_THROW(CheckViews({WithDepth(0.5f)}));
  TrainView view = WithDepth(0.5f);
  view.depth_mask = Tensor();
  EXPECT_THROW(CheckViews({view}), ShapeError);
  view = WithDepth(0.5f);
  view.inv_depth = Tensor();
  EXPECT_THROW(CheckViews({view}), ShapeError);
  view = WithDepth(0.5f);
  view.depth_mask = torch::ones({kHeight, kWidth + 1});
  EXPECT_THROW(CheckViews({view}), ShapeError);
}

TEST(CheckViewsTest, NamesTheInverseDepthThatIsNotFinite) {
  TrainView view = WithDepth(0.5f);
  view.inv_depth[3][7] = std::nanf("");
  try {
    CheckViews({view});
    ADD_FAILURE() << "a depth that is not a number was accepted";
  } catch (const ShapeError& e) {
    EXPECT_THAT(e.what(), HasSubstr("inv_depth of a is nan at column 7, row 3"));
  }
  view.depth_mask[3][7] = 0;
  EXPECT_NO_THROW(CheckViews({view}));
}

TEST(WithCleanDepthTest, DepthCountsOnlyWhereThePhotographDoes) {
  TrainView view = WithDepth(0.5f);
  view.inv_depth[3][7] = std::nanf("");
  view.depth_mask[3][7] = 0;
  view.depth_mask[4][8] = 0.25f;
  view.confidence = torch::ones({kHeight, kWidth});
  view.confidence[5].zero_();
  const TrainView clean = WithCleanDepth(view);
  EXPECT_EQ(clean.inv_depth[3][7].item<float>(), 0);
  EXPECT_EQ(clean.depth_mask[4][8].item<float>(), 0.25f);
  EXPECT_EQ(clean.depth_mask[5].abs().max().item<float>(), 0);
  EXPECT_EQ(clean.depth_mask.sum().item<float>(), kHeight * kWidth - kWidth - 1.75f);
  EXPECT_EQ(view.depth_mask[5].min().item<float>(), 1);  // not written
  view.confidence.zero_();
  EXPECT_FALSE(WithCleanDepth(view).inv_depth.defined());
  EXPECT_FALSE(WithCleanDepth(view).depth_mask.defined());
}

TEST(CharacteristicDepthTest, IsTheMedianOfTheViewsMedians) {
  EXPECT_EQ(CharacteristicDepth({}), 0);
  TrainView none{"b", CameraOnCircle(0), torch::rand({kHeight, kWidth, 3}), {}};
  EXPECT_EQ(CharacteristicDepth({none}), 0);
  TrainView near = WithDepth(0.5f), far = WithDepth(0.125f), farther = WithDepth(0.0625f);
  EXPECT_EQ(CharacteristicDepth({near}), 2);
  EXPECT_EQ(CharacteristicDepth({near, none, far, farther}), 8);
  far.inv_depth.narrow(0, 0, kHeight / 2 + 2).fill_(0.25f);  // most pixels
  EXPECT_EQ(CharacteristicDepth({near, far, farther}), 4);
  far.depth_mask.narrow(0, 0, kHeight / 2 + 2).zero_();  // which do not count
  EXPECT_EQ(CharacteristicDepth({near, far, farther}), 8);
}

}  // namespace
}  // namespace oraclegs
