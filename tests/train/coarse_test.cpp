#include "oraclegs/train/coarse.h"

#include "oraclegs/train/rows.h"
#include "support/golden.h"
#include "support/tensors.h"
#include "train/small_scene.h"

namespace oraclegs {
namespace {

TrainView Plain(int width, int height) {
  Camera camera{width, height, 40, 42, 3, 2.5, Eigen::Isometry3d::Identity()};
  camera.cam_from_world.translation() = Eigen::Vector3d(0, 0, 3);
  torch::manual_seed(7);
  return {"a", camera, torch::rand({height, width, 3}), {}};
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
  const Buffer<float> expected = view.image.reshape({2, 2, 3, 2, 3}).mean({1, 3});
  EXPECT_LE(MaxAbsError(half.image, expected), 1e-6);
}

TEST(HalfSizeTest, AlphaIsAveragedOverWhatCounts) {
  TrainView view = Plain(4, 2);
  view.alpha = torch::tensor({{1.f, 0.f, 0.5f, 0.5f}, {1.f, 0.f, 0.5f, 0.1f}});
  EXPECT_LE(MaxAbsError(HalfSize(view).alpha, torch::tensor({{0.5f, 0.4f}})), 1e-6);
  view.confidence = torch::tensor({{1.f, 0.f, 1.f, 1.f}, {1.f, 0.f, 1.f, 0.f}});
  EXPECT_LE(MaxAbsError(HalfSize(view).alpha, torch::tensor({{1.f, 0.5f}})), 1e-6);
}

TEST(HalfSizeTest, OddSizesAreRoundedUp) {
  const TrainView half = HalfSize(Plain(7, 1));
  EXPECT_EQ(half.camera.width, 4);
  EXPECT_EQ(half.camera.height, 1);
  EXPECT_EQ(half.image.shape(), (std::vector<int64_t>{1, 4, 3}));
  EXPECT_NEAR(half.camera.fx, 40 * 4 / 7.0, 1e-9);
  EXPECT_NEAR(half.camera.fy, 42, 1e-9);
}

TEST(HalfSizeTest, WhatDoesNotCountLeavesNoTrace) {
  TrainView view = Plain(4, 2);
  view.image[0][0].fill_(std::nanf(""));
  view.confidence = torch::tensor({{0.f, 1.f, 0.f, 0.f}, {1.f, 1.f, 0.f, 0.f}});
  view.depth_mask = torch::tensor({{0.f, 0.5f, 0.f, 0.f}, {0.f, 1.f, 0.f, 0.f}});
  view.inv_depth = torch::tensor({{9.f, 1.f, 9.f, 9.f}, {9.f, 4.f, 9.f, 9.f}});
  const TrainView half = HalfSize(view);
  EXPECT_LE(MaxAbsError(half.confidence, torch::tensor({{0.75f, 0.f}})), 1e-6);
  const Buffer<float> mean = (view.image[0][1] + view.image[1][0] + view.image[1][1]) / 3;
  EXPECT_LE(MaxAbsError(half.image[0][0], mean), 1e-6);
  EXPECT_EQ(half.image[0][1].abs().max().item<float>(), 0);
  EXPECT_LE(MaxAbsError(half.depth_mask, torch::tensor({{0.375f, 0.f}})), 1e-6);
  EXPECT_LE(MaxAbsError(half.inv_depth, torch::tensor({{3.f, 0.f}})), 1e-6);
}

TEST(HalfSizeTest, AProposalsConfidenceIsAWeight) {
  TrainView view = Plain(4, 2);
  view.confidence = torch::tensor({{0.2f, 0.6f, 0.f, 0.f}, {0.f, 0.4f, 0.f, 0.f}});
  const TrainView half = HalfSize(view, ViewKind::kProposal);
  EXPECT_LE(MaxAbsError(half.confidence, torch::tensor({{0.3f, 0.f}})), 1e-6);
  const Buffer<float> mean = (view.image[0][0] * 0.2 + view.image[0][1] * 0.6 + view.image[1][1] * 0.4) / 1.2;
  EXPECT_LE(MaxAbsError(half.image[0][0], mean), 1e-6);
  // Nothing is sure here, but windows that belong to the pixel beside it see what is proposed.
  EXPECT_LE(MaxAbsError(half.image[0][1], view.image.narrow(1, 2, 2).reshape({-1, 3}).mean(0)), 1e-6);
  EXPECT_TRUE(half.image.is_contiguous());
}

TEST(CoarseIterationsTest, LeavesTheLastIterationFine) {
  EXPECT_EQ(CoarseIterations(0, 1000), 0);
  EXPECT_EQ(CoarseIterations(0.3, 1000), 300);
  EXPECT_EQ(CoarseIterations(0.9, 1), 0);
}

TEST(TrainerCoarseTest, TheShareIsTrainedAtHalfSize) {
  // Photographs of a pattern as fine as a pixel: at half size it is grey, and the grey of the start fits it.
  auto views = Photographs(2);
  for (TrainView& view : views) {
    view.camera = Resized(view.camera, 36, 28);
    const Buffer<float> odd = (torch::arange(28).unsqueeze(1) + torch::arange(36)).remainder(2).to(torch::kFloat);
    view.image = odd.unsqueeze(2).expand({28, 36, 3});
  }
  TrainOptions options = Options(40);
  options.opacity_reg = options.scale_reg = options.ssim_weight = 0;
  options.coarse_share = 0.5;
  Gaussians none = Start();
  none.means.fill_(100);  // out of sight: the render is the background
  Trainer trainer(options, kSeed, {0.5f, 0.5f, 0.5f}, views, none);
  for (int i = 1; i <= 40; ++i) EXPECT_NEAR(trainer.Step(), i <= 20 ? 0 : 0.5, 1e-5) << i;
}

TEST(TrainerCoarseTest, ResumingGivesTheBitsOfAnUninterruptedRun) {
  TempDir dir;
  TrainOptions options = Options(60);
  options.coarse_share = 0.5;
  Trainer whole(options, kSeed, {0, 0, 0}, Photographs(3), Start());
  whole.Run({dir.path(), 25, {}}, Silent());
  Trainer resumed(options, kSeed, {0, 0, 0}, Photographs(3), Start());
  resumed.Restore(ReadCheckpoint(CheckpointPath(dir.path(), 25)));
  resumed.Run({}, Silent());
  EXPECT_TRUE(SameBits(resumed.gaussians(), whole.gaussians()));
}

}  // namespace
}  // namespace oraclegs
