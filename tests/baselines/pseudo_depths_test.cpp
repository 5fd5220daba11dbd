#include "oraclegs/baselines/pseudo_depths.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "baselines/baseline_trainer.h"
#include "oraclegs/baselines/pseudo_views.h"
#include "oraclegs/loss/depth_losses.h"
#include "support/buffers.h"
#include "support/errors.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;

constexpr double kWeight = 0.5;
constexpr int kStart = 20;

/// Pseudo depth from the true scene, from any camera.
PseudoDepth TrueDepthAnywhere() {
  return [](const Camera& camera, const Buffer<float>&, const CompareDepth& compare) {
    const auto rasterizer = MakeRasterizer(kCpu);
    const RenderOutput out = rasterizer->Forward(Truth(), camera, {}, RenderPass::kInference);
    compare({out.inv_depth.Clone(), {}});
    return Buffer<float>();
  };
}

BaselineSetup SetupOf(PseudoDepth depth, int iterations = 1000, int every = 10) {
  TrainOptions options = Options(iterations);
  options.opacity_reg = options.scale_reg = options.largest_scale = options.depth_weight = 0;
  BaselineSetup setup = SmallSetup(options, Photos(3));
  setup.baseline.pseudo_depth_weight = kWeight;
  setup.baseline.pseudo_depth_start = kStart;
  setup.baseline.pseudo_depth_every = every;
  setup.pseudo_depth = std::move(depth);
  return setup;
}

Iteration Numbered(int64_t number) {
  Iteration iteration;
  iteration.seed = kSeed;
  iteration.number = number;
  return iteration;
}

/// Gradients that the part adds in an iteration, and its loss.
struct Added {
  Gaussians grads;
  double loss = 0;
};

Added Ask(const BaselineSetup& setup, int64_t number) {
  TrainedModel model{Start(), Adam(Start().size())};
  PseudoDepths part(setup);
  PartGradients grads;
  Added added{{}, part.BeforeView(Numbered(number), &model, &grads)};
  added.grads = grads.at(0)->Clone();
  return added;
}

TEST(PseudoDepths, NeedADepth) {
  EXPECT_THAT(MessageOf<UsageError>([] { PseudoDepths part(SetupOf({})); }), HasSubstr("needs their depth"));
  EXPECT_NO_THROW(PseudoDepths(SetupOf(TrueDepthAnywhere())));
}

TEST(PseudoDepths, LookAtEachNthIterationBetweenStartAndEnd) {
  std::vector<int64_t> seen;
  int64_t now = 0;
  PseudoDepths part(SetupOf(
      [&](const Camera& camera, const Buffer<float>&, const CompareDepth& compare) {
        seen.push_back(now);
        compare({RandomUniform({camera.height, camera.width}, 1), {}});
        return Buffer<float>();
      },
      100));
  TrainedModel model{Start(), Adam(Start().size())};
  PartGradients grads;
  for (now = 1; now <= 100; ++now) part.BeforeView(Numbered(now), &model, &grads);
  EXPECT_THAT(seen, testing::ElementsAre(30, 40, 50, 60, 70, 80, 90));
}

TEST(PseudoDepths, HaveTheGradientOfTheCorrelationFromAPlaceBetweenThePhotos) {
  const BaselineSetup setup = SetupOf(TrueDepthAnywhere());
  const Added added = Ask(setup, kStart + kPseudoDepthRamp);
  const std::vector<Camera> views = PseudoViewsBetween(Cameras(setup.data.photos), kPseudoViews, kSeed);
  const Camera& camera = DrawPseudoView(views, kSeed, kStart + kPseudoDepthRamp);
  const auto rasterizer = MakeRasterizer(kCpu);
  const Buffer<float> truth = rasterizer->Forward(Truth(), camera, {}, RenderPass::kInference).inv_depth.Clone();
  const RenderOptions render{{0, 0, 0}, Iteration().sh_degree, false};
  const RenderOutput out = rasterizer->Forward(Start(), camera, render, RenderPass::kTrain);
  Buffer<float> grad = Buffer<float>::Empty(truth.shape());
  const double loss = PearsonDepthLoss({out.inv_depth, truth, {}}, kWeight, &grad);
  Gaussians expected = Gaussians::Zeros(Start().size());
  rasterizer->Backward(Start(), {{}, {}, grad}, &expected);
  EXPECT_GT(loss, 0.01 * kWeight);
  EXPECT_EQ(added.loss, loss);
  EXPECT_TRUE(SameBits(added.grads, expected));
  EXPECT_GT(Flat(expected.means).abs().maxCoeff(), 0);
}

TEST(PseudoDepths, BeginSoftly) {
  const BaselineSetup setup = SetupOf(TrueDepthAnywhere(), 10000, 1);
  const double at_once = Ask(setup, kStart + 1).loss;
  EXPECT_GT(at_once, 0);
  EXPECT_LT(at_once, 2 * kWeight / kPseudoDepthRamp);
}

TEST(PseudoDepths, PassTheDepthsGradientToTheRender) {
  double of_depth = 0;
  const auto network = [&](const Camera& camera, const Buffer<float>& image, const CompareDepth& compare) {
    Buffer<float> inv_depth = Buffer<float>::Empty({camera.height, camera.width});  // the red of the image
    for (int64_t i = 0; i < inv_depth.count(); ++i) inv_depth[i] = image[3 * i];
    const Buffer<float> grad = compare({inv_depth, {}});
    of_depth = Wide(grad).abs().maxCoeff();
    Buffer<float> of_image = Buffer<float>::Zeros(image.shape());
    for (int64_t i = 0; i < grad.count(); ++i) of_image[3 * i] = grad[i];
    return of_image;
  };
  const Added with = Ask(SetupOf(network), 600), without = Ask(SetupOf(TrueDepthAnywhere()), 600);
  EXPECT_GT(of_depth, 0);
  EXPECT_EQ(Flat(without.grads.sh).abs().maxCoeff(), 0);
  const auto sh = Table(with.grads.sh);
  EXPECT_GT(sh.col(0).abs().maxCoeff(), 0);
  EXPECT_EQ(sh.col(1).abs().maxCoeff(), 0) << "green has no part in it";
}

/// Mean correlation of depth with the truth after a training, seen from between the photos.
double CorrelationAfter(double weight) {
  BaselineSetup setup = SetupOf(TrueDepthAnywhere(), 200, 1);
  setup.baseline.pseudo_depth_weight = weight;
  const std::vector<Camera> views = PseudoViewsBetween(Cameras(setup.data.photos), 10, 99);
  Trainer trainer = BaselineTrainer(std::move(setup));
  trainer.Run({}, Silent());
  const auto rasterizer = MakeRasterizer(kCpu);
  double sum = 0;
  for (const Camera& view : views) {
    const Buffer<float> truth = rasterizer->Forward(Truth(), view, {}, RenderPass::kInference).inv_depth.Clone();
    const RenderOutput out = rasterizer->Forward(trainer.gaussians(), view, {}, RenderPass::kInference);
    sum += 1 - PearsonDepthLoss({out.inv_depth, truth, {}}, 1, nullptr);
  }
  return sum / static_cast<double>(views.size());
}

TEST(PseudoDepths, BringTheDepthNearer) {
  const double without = CorrelationAfter(0), with = CorrelationAfter(5);
  EXPECT_GT(1 - without, 1.2 * (1 - with)) << without << " " << with;
}

}  // namespace
}  // namespace oraclegs
