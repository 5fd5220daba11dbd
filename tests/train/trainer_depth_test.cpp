// Depth as a term of the trainer's loss.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "oraclegs/render/render.h"
#include "oraclegs/train/schedule.h"
#include "support/buffers.h"
#include "train/small_scene.h"

namespace oraclegs {
namespace {

/// Photos with the depth that the rasterizer finds, where the Gaussians cover the view.
std::vector<TrainView> WithTrueDepth(int count) {
  auto views = Photos(count);
  auto rasterizer = MakeRasterizer(kCpu);
  for (TrainView& view : views) {
    const RenderOutput out = rasterizer->Forward(Truth(), view.camera, {}, RenderPass::kInference);
    view.inv_depth = out.inv_depth.Clone();
    view.depth_mask = Above(out.alpha, 0.9f);
  }
  return views;
}

TrainOptions OnlyDepth(double weight) {
  TrainOptions options = Options();
  options.opacity_reg = options.scale_reg = 0;
  options.depth_weight = weight;
  return options;
}

double FirstLoss(const TrainOptions& options, const std::vector<TrainView>& views) {
  return Trainer(options, kSeed, {0, 0, 0}, views, Truth()).Step();
}

Gaussians After(int steps, const TrainOptions& options, const std::vector<TrainView>& views) {
  Trainer trainer(options, kSeed, {0, 0, 0}, views, Start());
  for (int i = 0; i < steps; ++i) trainer.Step();
  return trainer.gaussians().Clone();
}

TEST(TrainerDepthTest, TheTermIsThatOfTheFormula) {
  auto views = WithTrueDepth(1);
  EXPECT_NEAR(FirstLoss(OnlyDepth(1), views), 0, 1e-5);
  const double error = 0.25;
  Flat(views[0].inv_depth) += static_cast<float>(error);
  const TrainView clean = WithCleanDepth(views[0]);
  const double expected = 3 * DepthWeight(1, Options().iterations) * CharacteristicDepth({clean}) * error *
                          Wide(views[0].depth_mask).mean();
  EXPECT_GT(expected, 0.01);
  EXPECT_NEAR(FirstLoss(OnlyDepth(3), views), expected, 1e-4);
  EXPECT_NEAR(FirstLoss(OnlyDepth(0), views), 0, 1e-5);
  views[0].pixel_weight =
      Buffer<float>::Zeros({kHeight, kWidth});  // where the photo does not count, its depth does not
  EXPECT_EQ(FirstLoss(OnlyDepth(3), views), 0);
}

TEST(TrainerDepthTest, DoesNotDependOnTheUnitOfTheWorld) {
  auto views = WithTrueDepth(2);
  for (TrainView& view : views) Flat(view.inv_depth) += 0.1f;
  const double loss = FirstLoss(OnlyDepth(1), views);
  EXPECT_GT(loss, 0.01);
  Gaussians truth = Truth();
  const float unit = 7;  // what was 1 long is 7 long
  Flat(truth.means) *= unit;
  Flat(truth.log_scales) += std::log(unit);
  for (TrainView& view : views) {
    Flat(view.inv_depth) /= unit;
    view.camera.cam_from_world.translation() *= static_cast<double>(unit);
  }
  EXPECT_NEAR(Trainer(OnlyDepth(1), kSeed, {0, 0, 0}, views, truth).Step(), loss, 1e-4 * loss);
}

TEST(TrainerDepthTest, WithoutDepthOrWeightTheBitsAreTheSame) {
  const auto plain = Photos(3);
  auto deep = WithTrueDepth(3);
  const Gaussians expected = After(45, Options(), plain);
  TrainOptions off = Options();
  off.depth_weight = 0;
  EXPECT_TRUE(SameBits(After(45, off, deep), expected));
  EXPECT_FALSE(SameBits(After(45, Options(), deep), expected));
  for (TrainView& view : deep) view.depth_mask.SetZero();
  EXPECT_TRUE(SameBits(After(45, Options(), deep), expected));
}

/// Sum over the views of mean(|inv_depth - rendered| * depth_mask).
double DepthError(const Gaussians& gaussians, const std::vector<TrainView>& views) {
  double sum = 0;
  auto rasterizer = MakeRasterizer(kCpu);
  for (const TrainView& view : views) {
    const RenderOutput out = rasterizer->Forward(gaussians, view.camera, {}, RenderPass::kInference);
    sum += ((Wide(out.inv_depth) - Wide(view.inv_depth)).abs() * Wide(view.depth_mask)).mean();
  }
  return sum;
}

TEST(TrainerDepthTest, BringsTheRenderToTheDepthWherePicturesSayNothing) {
  auto views = WithTrueDepth(4);
  Gaussians start = Truth();
  Table(start.means).col(2) += 0.2f;  // behind where they belong
  Flat(start.sh).setConstant(-100);   // black before black: no image shows it
  for (TrainView& view : views) view.image.SetZero();
  const double before = DepthError(start, views);
  const auto after = [&](double weight) {
    TrainOptions options = OnlyDepth(weight);
    options.refine_stop = 0;
    Trainer trainer(options, kSeed, {0, 0, 0}, views, start);
    for (int i = 0; i < options.iterations; ++i) trainer.Step();
    return DepthError(trainer.gaussians(), views);
  };
  EXPECT_GT(after(0), 0.9 * before);
  EXPECT_LT(after(1), 0.5 * before);
}

TEST(TrainerDepthTest, RefusesDepthThatDoesNotFit) {
  auto views = WithTrueDepth(2);
  views[1].depth_mask = Buffer<float>();
  EXPECT_THROW(Trainer(Options(), kSeed, {0, 0, 0}, views, Start()), ShapeError);
}

}  // namespace
}  // namespace oraclegs
