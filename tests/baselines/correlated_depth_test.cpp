#include "oraclegs/baselines/correlated_depth.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "baselines/baseline_trainer.h"
#include "oraclegs/loss/depth_losses.h"

namespace oraclegs {
namespace {

constexpr uint64_t kPatchSeed = 7;

/// Photos of random depth; the second has none.
BaselineSetup CorrelatedSetup() {
  BaselineSetup setup = SmallSetup(Options(100), Photos(2));
  setup.data.photos[0].inv_depth = RandomUniform({kHeight, kWidth}, 32);
  setup.data.photos[0].depth_mask = RandomUniform({kHeight, kWidth}, 33);
  setup.baseline.depth_correlation = 0.05;
  return setup;
}

RenderOutput AnyRender() {
  return {RandomUniform({kHeight, kWidth, 3}, 119), RandomUniform({kHeight, kWidth}, 120),
          RandomUniform({kHeight, kWidth}, 121)};
}

Iteration OfPhoto(int photo, int64_t number) {
  Iteration iteration;
  iteration.seed = kPatchSeed;
  iteration.number = number;
  iteration.view = {ViewKind::kPhoto, photo};
  return iteration;
}

DepthImages ImagesOf(const BaselineSetup& setup, const RenderOutput& out) {
  const TrainView photo = WithCleanDepth(setup.data.photos[0]);
  return {out.inv_depth, photo.inv_depth, photo.depth_mask};
}

TEST(CorrelatedDepth, IsTheCorrelationOfPhotosThatHaveDepth) {
  const BaselineSetup setup = CorrelatedSetup();
  CorrelatedDepth part(setup);
  const RenderOutput out = AnyRender();
  RenderGrads grads;
  const double loss = part.OnView(OfPhoto(0, 30), out, &grads);
  Buffer<float> expected = Buffer<float>::Empty({kHeight, kWidth});
  EXPECT_EQ(loss, PearsonDepthLoss(ImagesOf(setup, out), 0.05, &expected));
  EXPECT_GT(loss, 0);
  EXPECT_TRUE(Equal(grads.inv_depth, expected));
  EXPECT_FALSE(grads.image.defined());

  RenderGrads none;
  EXPECT_EQ(part.OnView(OfPhoto(1, 30), out, &none), 0) << "this photo has no depth";
  Iteration proposal = OfPhoto(0, 30);
  proposal.view.kind = ViewKind::kProposal;
  EXPECT_EQ(part.OnView(proposal, out, &none), 0);
  EXPECT_FALSE(none.inv_depth.defined());
}

TEST(CorrelatedDepth, CountsLessInTheEnd) {
  BaselineSetup setup = CorrelatedSetup();
  setup.baseline.late_correlation = 0.02;
  CorrelatedDepth part(setup);
  const auto loss = [&](int64_t number) {
    RenderGrads grads;
    return part.OnView(OfPhoto(0, number), AnyRender(), &grads);
  };
  EXPECT_EQ(loss(95), loss(1));
  EXPECT_NEAR(loss(96), 0.02 * loss(1), 1e-9);
}

TEST(CorrelatedDepth, AddsPatchesAndKeepsTheGradientThatIsThere) {
  BaselineSetup setup = CorrelatedSetup();
  setup.baseline.patched_correlation = 0.15;
  CorrelatedDepth part(setup);
  const RenderOutput out = AnyRender();
  RenderGrads grads;
  grads.inv_depth = Buffer<float>::Full({kHeight, kWidth}, 0.5f);
  const double loss = part.OnView(OfPhoto(0, 30), out, &grads);
  Buffer<float> whole = Buffer<float>::Zeros({kHeight, kWidth}), patched = whole.Clone();
  const DepthImages images = ImagesOf(setup, out);
  const double of_whole = PearsonDepthLoss(images, 0.05, &whole);
  const double of_patches =
      PatchPearsonDepthLoss(images, RandomPatches(kHeight, kWidth, {}, kPatchSeed, 30), 0.15, &patched);
  EXPECT_GT(of_patches, 0);
  EXPECT_DOUBLE_EQ(loss, of_whole + of_patches);
  Flat(whole) += Flat(patched);
  Flat(whole) += 0.5f;
  EXPECT_LT(MaxAbsError(grads.inv_depth, whole), 1e-6);
}

}  // namespace
}  // namespace oraclegs
