#include "oraclegs/baselines/depth_steps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "baselines/baseline_trainer.h"
#include "support/errors.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

constexpr uint64_t kDepthPartSeed = 5;

/// Photos with depth where the scene covers them; the last one has none.
std::vector<TrainView> PhotosWithDepth(int count) {
  std::vector<TrainView> views = Photos(count);
  auto rasterizer = MakeRasterizer(kCpu);
  for (TrainView& view : views) {
    if (&view == &views.back() && count > 1) continue;
    const RenderOutput out = rasterizer->Forward(Truth(), view.camera, {}, RenderPass::kInference);
    view.inv_depth = out.inv_depth.Clone();
    view.depth_mask = Above(out.alpha, 0.3f);
  }
  return views;
}

BaselineSetup DepthSetup(bool hard, int soft_start, int iterations = 100) {
  TrainOptions options = Options(iterations);
  options.opacity_reg = options.scale_reg = options.largest_scale = options.depth_weight = 0;
  BaselineSetup setup = SmallSetup(options, PhotosWithDepth(3));
  setup.baseline.hard_depth = hard;
  setup.baseline.soft_depth_start = soft_start;
  return setup;
}

/// An iteration in which positions and opacities move by known rates.
Iteration DepthIteration(int64_t number, int photo = 0) {
  Iteration iteration;
  iteration.seed = kDepthPartSeed;
  iteration.number = number;
  iteration.view = {ViewKind::kPhoto, photo};
  iteration.rates.means = 1e-3;
  return iteration;
}

/// The start after a step, so that no moment is zero.
TrainedModel MovingModel() {
  TrainedModel model{Start(), Adam(60)};
  model.adam.Step(RandomGaussians(60, 30), {1e-3}, 3, &model.gaussians);
  return model;
}

TrainedModel CloneOfModel(const TrainedModel& model) {
  TrainedModel clone = model;
  for (Gaussians* group : {&clone.gaussians, &clone.adam.m, &clone.adam.v}) *group = group->Clone();
  return clone;
}

TrainedModel AfterPart(DepthSteps* part, const TrainedModel& model, const Iteration& iteration) {
  TrainedModel after = CloneOfModel(model);
  PartGradients grads;
  EXPECT_EQ(part->BeforeView(iteration, &after, &grads), 0);
  EXPECT_TRUE(grads.empty());
  EXPECT_EQ(after.adam.step, model.adam.step);
  return after;
}

/// Expects that only one tensor has changed; the others have equal bits.
void ExpectOnlyChanged(const TrainedModel& before, const TrainedModel& after, size_t changed) {
  const std::pair<const Gaussians&, const Gaussians&> pairs[] = {
      {before.gaussians, after.gaussians}, {before.adam.m, after.adam.m}, {before.adam.v, after.adam.v}};
  for (const auto& [then, now] : pairs) {
    for (size_t k = 0; k < 5; ++k) EXPECT_EQ(SameBytes(Tensors(then)[k], Tensors(now)[k]), k != changed) << k;
  }
}

bool SameModel(const TrainedModel& a, const TrainedModel& b) {
  return SameBits(a.gaussians, b.gaussians) && SameBits(a.adam.m, b.adam.m) && SameBits(a.adam.v, b.adam.v);
}

/// Independent dL/d(raw) of the depth loss of this render.
Gaussians SlowDepthGradient(const Gaussians& gaussians, const BaselineSetup& setup, const Iteration& iteration) {
  auto rasterizer = MakeRasterizer(kCpu);
  const TrainView photo = WithCleanDepth(setup.data.photos[static_cast<size_t>(iteration.view.index)]);
  const RenderOutput out = rasterizer->Forward(gaussians, photo.camera, {}, RenderPass::kTrain);
  Buffer<float> local = Buffer<float>::Zeros(out.inv_depth.shape()), global = local.Clone();
  const DepthImages images{out.inv_depth, photo.inv_depth, photo.depth_mask};
  const auto side = [&](DepthNormalization normalization) {
    return DrawPatchSide({}, normalization, iteration.seed, iteration.number);
  };
  const double tolerance = setup.baseline.depth_tolerance;
  NormalizedDepthLoss(images, {DepthNormalization::kLocal, side(DepthNormalization::kLocal), tolerance}, 0.1, &local);
  NormalizedDepthLoss(images, {DepthNormalization::kGlobal, side(DepthNormalization::kGlobal), tolerance}, 1, &global);
  Flat(local) += Flat(global);
  Gaussians grads = Gaussians::Zeros(gaussians.size());
  rasterizer->Backward(gaussians, {{}, {}, local}, &grads);
  return grads;
}

TEST(HardDepth, MovesPositionsAloneByTheDepthOfOpaqueGaussians) {
  const BaselineSetup setup = DepthSetup(true, 0);
  DepthSteps part(setup);
  const TrainedModel before = MovingModel(), after = AfterPart(&part, before, DepthIteration(10));
  ExpectOnlyChanged(before, after, 0);

  Gaussians opaque = before.gaussians.Clone();
  Flat(opaque.opacity_logits).setConstant(static_cast<float>(std::log(0.95 / 0.05)));
  TrainedModel expected = CloneOfModel(before);
  expected.adam.StepGroup(&Gaussians::means, SlowDepthGradient(opaque, setup, DepthIteration(10)), 1e-3,
                          &expected.gaussians);
  EXPECT_LT(MaxAbsError(after.gaussians.means, expected.gaussians.means), 1e-6);
  EXPECT_LT(RelativeL2(after.adam.m.means, expected.adam.m.means), 1e-5);
  EXPECT_GT(MaxAbsError(after.gaussians.means, before.gaussians.means), 1e-5);
}

TEST(SoftDepth, MovesOpacitiesAloneByTheDepthAsItIs) {
  const BaselineSetup setup = DepthSetup(false, 15);
  DepthSteps part(setup);
  const TrainedModel before = MovingModel(), after = AfterPart(&part, before, DepthIteration(20));
  ExpectOnlyChanged(before, after, 3);
  Iteration slow = DepthIteration(20);
  slow.seed += kSoftPatchSeed;
  TrainedModel expected = CloneOfModel(before);
  expected.adam.StepGroup(&Gaussians::opacity_logits, SlowDepthGradient(before.gaussians, setup, slow),
                          slow.rates.opacity_logits, &expected.gaussians);
  EXPECT_LT(MaxAbsError(after.gaussians.opacity_logits, expected.gaussians.opacity_logits), 1e-5);
  EXPECT_LT(RelativeL2(after.adam.m.opacity_logits, expected.adam.m.opacity_logits), 1e-5);
  EXPECT_GT(MaxAbsError(after.gaussians.opacity_logits, before.gaussians.opacity_logits), 1e-3);
}

TEST(DepthSteps, AreMadeInTheirIterationsAlone) {
  BaselineSetup setup = DepthSetup(true, 15);  // densification ends before iteration 83.3
  DepthSteps part(setup);
  const TrainedModel before = MovingModel();
  const auto moves = [&](Iteration iteration) { return !SameModel(before, AfterPart(&part, before, iteration)); };
  for (const int64_t number : {10, 20, 80}) EXPECT_TRUE(moves(DepthIteration(number))) << number;
  for (const int64_t number : {1, 9, 11, 19, 90, 100}) EXPECT_FALSE(moves(DepthIteration(number))) << number;
  EXPECT_TRUE(moves(DepthIteration(10, 1)));
  EXPECT_FALSE(moves(DepthIteration(10, 2))) << "this photo has no depth";
  Iteration other = DepthIteration(10);
  other.view.kind = ViewKind::kProposal;
  EXPECT_FALSE(moves(other));
  other = DepthIteration(10);
  other.moves = false;
  EXPECT_FALSE(moves(other)) << "the last iteration";
  ExpectOnlyChanged(before, AfterPart(&part, before, DepthIteration(10)), 0);  // no soft depth yet

  setup.baseline.depth_step_every = 3;
  DepthSteps often(setup);
  EXPECT_FALSE(SameModel(before, AfterPart(&often, before, DepthIteration(9))));
  EXPECT_TRUE(SameModel(before, AfterPart(&often, before, DepthIteration(10))));
}

TEST(DepthSteps, NeedDepth) {
  BaselineSetup setup = DepthSetup(true, 0);
  for (TrainView& photo : setup.data.photos) photo.inv_depth = photo.depth_mask = {};
  const std::string message = MessageOf<UsageError>([&] { AddBaseline(&setup); });
  EXPECT_THAT(message, testing::HasSubstr("steps by depth need the depth of the photos"));
  EXPECT_THAT(message, testing::Not(testing::HasSubstr("\n")));
  setup.baseline = {};
  setup.baseline.soft_depth_start = 1000;
  EXPECT_THAT(MessageOf<UsageError>([&] { AddBaseline(&setup); }), testing::HasSubstr("steps by depth need"));
}

BaselineSetup AdaptiveDepthSetup(int soft_start) {
  BaselineSetup setup = DepthSetup(true, soft_start);
  setup.baseline.adaptive = true;
  setup.baseline.opacity_reset = 0;
  setup.options.max_gaussians = 300;
  return setup;
}

TEST(DepthSteps, FitTheShapeOfTheDepthWherePhotosSayNothing) {
  BaselineSetup setup = DepthSetup(true, 0, 300);
  setup.options.refine_start = 1000;
  setup.options.rate_scale = 10;
  setup.baseline.depth_step_every = 1;
  setup.baseline.adaptive = true;
  for (TrainView& photo : setup.data.photos) photo.image.SetZero();  // black before black: none shows the Gaussians
  setup.start = Truth();
  Flat(setup.start.sh).setConstant(-100);
  Table(setup.start.means).col(2) += 0.3f * Table(RandomGaussians(40, 5).means).col(2);
  const TrainView photo = WithCleanDepth(setup.data.photos[0]);
  const auto error = [&](const Gaussians& gaussians) {
    auto rasterizer = MakeRasterizer(kCpu);
    Gaussians opaque = gaussians.Clone();
    Flat(opaque.opacity_logits).setConstant(static_cast<float>(std::log(0.95 / 0.05)));
    const RenderOutput out = rasterizer->Forward(opaque, photo.camera, {}, RenderPass::kInference);
    return NormalizedDepthLoss({out.inv_depth, photo.inv_depth, photo.depth_mask}, {DepthNormalization::kGlobal, 16, 0},
                               1, nullptr);
  };
  const double before = error(setup.start);
  Trainer trainer = BaselineTrainer(std::move(setup));
  trainer.Run({}, Silent());
  EXPECT_LT(error(trainer.gaussians()), 0.7 * before) << before;
}

TEST(DepthSteps, GiveTheSameBitsForAnyNumberOfThreadsAndResumed) {
  TempDir dir;
  Trainer whole = BaselineTrainer(AdaptiveDepthSetup(35));
  whole.Run({dir.path(), 45, {}}, Silent());
  BaselineSetup without = AdaptiveDepthSetup(0);
  without.baseline.hard_depth = false;
  Trainer plain = BaselineTrainer(std::move(without));
  plain.Run({}, Silent());
  EXPECT_FALSE(SameBits(whole.gaussians(), plain.gaussians()));

  const Threads scope(3);
  Trainer threads = BaselineTrainer(AdaptiveDepthSetup(35));
  threads.Run({}, Silent());
  EXPECT_TRUE(SameBits(threads.gaussians(), whole.gaussians()));
  Trainer resumed = BaselineTrainer(AdaptiveDepthSetup(35));
  resumed.Restore(ReadCheckpoint(CheckpointPath(dir.path(), 45)));
  resumed.Run({}, Silent());
  EXPECT_TRUE(SameBits(resumed.gaussians(), whole.gaussians()));
}

}  // namespace
}  // namespace oraclegs
