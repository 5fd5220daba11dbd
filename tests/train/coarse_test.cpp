#include "oraclegs/train/coarse.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/buffers.h"
#include "support/temp_dir.h"
#include "train/small_scene.h"

namespace oraclegs {
namespace {

/// An image from its values, row by row; 1 x 2 and 2 x 4 pixels are what these tests use.
Buffer<float> Plane(int64_t height, std::initializer_list<float> values) {
  return Buffer<float>::From({height, static_cast<int64_t>(values.size()) / height}, values);
}

/// A pixel's colors.
Eigen::ArrayXd Pixel(const Buffer<float>& image, int64_t y, int64_t x) {
  return Table(image).row(y).segment(3 * x, 3).cast<double>().transpose();
}

TrainView Plain(int width, int height) {
  Camera camera{width, height, 40, 42, 3, 2.5, Eigen::Isometry3d::Identity()};
  camera.cam_from_world.translation() = Eigen::Vector3d(0, 0, 3);
  return {"a", camera, RandomUniform({height, width, 3}, 101), {}};
}

TEST(HalfSizeTest, AveragesSquaresOfFourPixels) {
  const TrainView view = Plain(6, 4), half = HalfSize(view);
  EXPECT_EQ(half.name, "a");
  EXPECT_EQ(half.camera.width, 3);
  EXPECT_EQ(half.camera.height, 2);
  EXPECT_EQ(half.camera.fx, 20);
  EXPECT_EQ(half.camera.fy, 21);
  EXPECT_EQ(half.camera.cx, 1.5);
  EXPECT_EQ(half.camera.cy, 1.25);
  EXPECT_FALSE(half.confidence.defined());
  EXPECT_FALSE(half.inv_depth.defined());
  for (int i = 0; i < half.image.count(); ++i) {
    const int y = 2 * (i / 9), x = 2 * (i / 3 % 3), c = i % 3;
    const auto at = [&](int row, int column) { return view.image[(row * 6 + column) * 3 + c]; };
    EXPECT_NEAR(half.image[i], (at(y, x) + at(y, x + 1) + at(y + 1, x) + at(y + 1, x + 1)) / 4, 1e-6) << i;
  }
}

TEST(HalfSizeTest, AlphaIsAveragedOverWhatCounts) {
  TrainView view = Plain(4, 2);
  view.alpha = Plane(2, {1, 0, 0.5f, 0.5f, 1, 0, 0.5f, 0.1f});
  EXPECT_LE(MaxAbsError(HalfSize(view).alpha, Plane(1, {0.5f, 0.4f})), 1e-6);
  view.confidence = Plane(2, {1, 0, 1, 1, 1, 0, 1, 0});
  EXPECT_LE(MaxAbsError(HalfSize(view).alpha, Plane(1, {1, 0.5f})), 1e-6);
}

TEST(HalfSizeTest, OddSizesAreRoundedUp) {
  const TrainView half = HalfSize(Plain(7, 1));
  EXPECT_EQ(half.camera.width, 4);
  EXPECT_EQ(half.camera.height, 1);
  EXPECT_EQ(half.image.shape(), (Shape{1, 4, 3}));
  EXPECT_NEAR(half.camera.fx, 40 * 4 / 7.0, 1e-9);
  EXPECT_NEAR(half.camera.fy, 42, 1e-9);
}

TEST(HalfSizeTest, WhatDoesNotCountLeavesNoTrace) {
  TrainView view = Plain(4, 2);
  Flat(view.image).head(3).setConstant(std::nanf(""));
  view.confidence = Plane(2, {0, 1, 0, 0, 1, 1, 0, 0});
  view.depth_mask = Plane(2, {0, 0.5f, 0, 0, 0, 1, 0, 0});
  view.inv_depth = Plane(2, {9, 1, 9, 9, 9, 4, 9, 9});
  const TrainView half = HalfSize(view);
  EXPECT_LE(MaxAbsError(half.confidence, Plane(1, {0.75f, 0})), 1e-6);
  const Eigen::ArrayXd mean = (Pixel(view.image, 0, 1) + Pixel(view.image, 1, 0) + Pixel(view.image, 1, 1)) / 3;
  EXPECT_LE(MaxAbsError(Pixel(half.image, 0, 0), mean), 1e-6);
  EXPECT_EQ(Pixel(half.image, 0, 1).abs().maxCoeff(), 0);
  EXPECT_LE(MaxAbsError(half.depth_mask, Plane(1, {0.375f, 0})), 1e-6);
  EXPECT_LE(MaxAbsError(half.inv_depth, Plane(1, {3, 0})), 1e-6);
}

TEST(HalfSizeTest, AProposalsConfidenceIsAWeight) {
  TrainView view = Plain(4, 2);
  view.confidence = Plane(2, {0.2f, 0.6f, 0, 0, 0, 0.4f, 0, 0});
  const TrainView half = HalfSize(view, ViewKind::kProposal);
  EXPECT_LE(MaxAbsError(half.confidence, Plane(1, {0.3f, 0})), 1e-6);
  const Eigen::ArrayXd mean =
      (Pixel(view.image, 0, 0) * 0.2 + Pixel(view.image, 0, 1) * 0.6 + Pixel(view.image, 1, 1) * 0.4) / 1.2;
  EXPECT_LE(MaxAbsError(Pixel(half.image, 0, 0), mean), 1e-6);
  // Nothing is sure here, but windows that belong to the pixel beside it see what is proposed.
  const Eigen::ArrayXd plain =
      (Pixel(view.image, 0, 2) + Pixel(view.image, 0, 3) + Pixel(view.image, 1, 2) + Pixel(view.image, 1, 3)) / 4;
  EXPECT_LE(MaxAbsError(Pixel(half.image, 0, 1), plain), 1e-6);
}

TEST(CoarseIterationsTest, LeavesTheLastIterationFine) {
  EXPECT_EQ(CoarseIterations(0, 1000), 0);
  EXPECT_EQ(CoarseIterations(0.3, 1000), 300);
  EXPECT_EQ(CoarseIterations(0.9, 1), 0);
}

TEST(TrainerCoarseTest, TheShareIsTrainedAtHalfSize) {
  // Photos of a pattern as fine as a pixel: at half size it is gray, and the gray of the start fits it.
  auto views = Photos(2);
  for (TrainView& view : views) {
    view.camera = Resized(view.camera, 36, 28);
    view.image = Buffer<float>::Empty({28, 36, 3});
    for (int64_t i = 0; i < view.image.count(); ++i) {
      const int64_t pixel = i / 3;
      view.image[i] = static_cast<float>((pixel / 36 + pixel % 36) % 2);
    }
  }
  TrainOptions options = Options(40);
  options.opacity_reg = options.scale_reg = options.ssim_weight = 0;
  options.coarse_share = 0.5;
  Gaussians none = Start();
  Flat(none.means).setConstant(100);  // out of sight: the render is the background
  Trainer trainer(options, kSeed, {0.5f, 0.5f, 0.5f}, views, none);
  for (int i = 1; i <= 40; ++i) EXPECT_NEAR(trainer.Step(), i <= 20 ? 0 : 0.5, 1e-5) << i;
}

TEST(TrainerCoarseTest, ResumingGivesTheBitsOfAnUninterruptedRun) {
  TempDir dir;
  TrainOptions options = Options(60);
  options.coarse_share = 0.5;
  Trainer whole(options, kSeed, {0, 0, 0}, Photos(3), Start());
  whole.Run({dir.path(), 25, {}}, Silent());
  Trainer resumed(options, kSeed, {0, 0, 0}, Photos(3), Start());
  resumed.Restore(ReadCheckpoint(CheckpointPath(dir.path(), 25)));
  resumed.Run({}, Silent());
  EXPECT_TRUE(SameBits(resumed.gaussians(), whole.gaussians()));
}

}  // namespace
}  // namespace oraclegs
