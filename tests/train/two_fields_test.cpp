#include "oraclegs/train/methods/two_fields.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "oraclegs/train/make_train_device.h"
#include "support/buffers.h"
#include "train/small_scene.h"

namespace oraclegs {
namespace {

TrainSetup SetupOf(int iterations, int co_start) {
  TrainOptions options = Options(iterations);
  options.baseline.densify = Densify::kAdaptive;
  options.baseline.opacity_reset = 0;
  options.baseline.two_fields = true;
  options.baseline.co_start = co_start;
  options.opacity_reg = options.scale_reg = options.largest_scale = 0;
  options.max_gaussians = 300;
  return {options, kSeed, {0, 0, 0}, Photos(3), Start()};
}

struct Pair {
  Gaussians first, second;
};

Pair Train(TrainSetup setup) {
  const auto fields = std::make_shared<TwoFields>(setup);
  setup.parts = {fields};
  Trainer trainer(std::move(setup), [](const TrainDeviceSetup& s) { return MakeTrainDevice(kCpu, s); });
  trainer.Run({}, Silent());
  return {trainer.gaussians().Clone(), fields->second().Clone()};
}

/// How far the renders of both differ halfway between two photos.
double Disagreement(const Pair& pair) {
  auto rasterizer = MakeRasterizer(kCpu);
  const Camera camera = CameraOnCircle(0.15);
  const Buffer<float> a = rasterizer->Forward(pair.first, camera, {}, RenderPass::kInference).image.Clone();
  const Buffer<float> b = rasterizer->Forward(pair.second, camera, {}, RenderPass::kInference).image;
  return (Wide(a) - Wide(b)).abs().mean();
}

TEST(TwoFields, LeaveTheFirstModelAloneUntilTheyAreToAgree) {
  TrainSetup alone = SetupOf(60, 1000);
  Trainer trainer(std::move(alone), [](const TrainDeviceSetup& s) { return MakeTrainDevice(kCpu, s); });
  trainer.Run({}, Silent());
  const Pair pair = Train(SetupOf(60, 1000));
  EXPECT_TRUE(SameBits(pair.first, trainer.gaussians()));
  EXPECT_NE(pair.second.size(), 0);
  EXPECT_FALSE(SameBits(pair.first, pair.second)) << "halves of what is split are drawn anew";
}

TEST(TwoFields, AgreeMoreWhereTheyArePulledTogether) {
  const double apart = Disagreement(Train(SetupOf(150, 1000))), together = Disagreement(Train(SetupOf(150, 1)));
  EXPECT_GT(apart, 0);
  EXPECT_LT(together, 0.8 * apart);
}

TEST(TwoFields, AreTheSameForAnyNumberOfThreads) {
  const Pair pair = Train(SetupOf(80, 40));
  const Threads scope(3);
  const Pair again = Train(SetupOf(80, 40));
  EXPECT_TRUE(SameBits(pair.first, again.first));
  EXPECT_TRUE(SameBits(pair.second, again.second));
}

TEST(TwoFields, RemoveWhatOnlyOneHas) {
  TrainSetup setup = SetupOf(600, 1000);
  setup.options.baseline.co_prune_distance = 0.5;
  TwoFields fields(setup);
  TrainedModel model{setup.start.Clone(), Adam(setup.start.size())};
  Gaussians grads = Gaussians::Zeros(setup.start.size());
  fields.BeforeView({}, &model, &grads);  // the second model stands near the start
  model.gaussians.means[3 * 7] += 100;
  Iteration iteration;
  iteration.number = 500;
  std::vector<bool> keep(static_cast<size_t>(setup.start.size()), true);
  fields.Prune(iteration, model.gaussians, &keep);
  EXPECT_EQ(std::count(keep.begin(), keep.end(), false), 1);
  EXPECT_FALSE(keep[7]);
  std::fill(keep.begin(), keep.end(), true);
  iteration.number = 510;
  fields.Prune(iteration, model.gaussians, &keep);
  EXPECT_EQ(std::count(keep.begin(), keep.end(), false), 0) << "only every 500 iterations";
}

}  // namespace
}  // namespace oraclegs
