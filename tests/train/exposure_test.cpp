#include "oraclegs/train/exposure.h"

#include <cmath>

#include "oraclegs/train/rows.h"
#include "support/golden.h"
#include "support/tensors.h"
#include "train/small_scene.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;

ExposureMap Gain(float gain) { return {gain, 0, 0, 0, 0, gain, 0, 0, 0, 0, gain, 0}; }

ExposureMap RandomMap() {
  ExposureMap map = kIdentityExposure;
  const Buffer<float> offset = torch::randn({12}) * 0.2;
  for (int k = 0; k < 12; ++k) map[k] += offset.data()[k];
  return map;
}

Buffer<float> Applied(const Exposures& exposures, int view, const Buffer<float>& image) {
  const Buffer<float> shown = Buffer<float>::Empty(image.shape());
  exposures.Apply(view, image, shown);
  return shown;
}

TEST(ExposuresTest, TheIdentityChangesNoBit) {
  torch::manual_seed(1);
  const Buffer<float> image = torch::rand({31, 17, 3});
  const Exposures exposures({kIdentityExposure, kIdentityExposure});
  EXPECT_EQ(exposures.maps()[1], kIdentityExposure);
  EXPECT_TRUE(torch::equal(Applied(exposures, 1, image), image));
}

TEST(ExposuresTest, GradientsMatchCentralDifferences) {
  torch::manual_seed(2);
  const std::vector<ExposureMap> maps = {RandomMap(), RandomMap(), RandomMap()};
  Exposures exposures(maps);
  Buffer<float> image = torch::rand({8, 7, 3}), upstream = torch::randn({8, 7, 3});
  Buffer<float> grad = upstream.Clone();
  const ExposureGradient by_map = exposures.Backward(1, image, grad);

  // In double, as a function of the map that the gauge has left.
  const Buffer<float> pixels = image.reshape({-1, 3}).to(torch::kDouble),
               weights = upstream.reshape({-1, 3}).to(torch::kDouble);
  const auto loss = [&](const Buffer<float>& map, const Buffer<float>& x) {
    return ((x.matmul(map.narrow(1, 0, 3).t()) + map.select(1, 3)) * weights).sum().item<double>();
  };
  std::vector<double> values(exposures.maps()[1].begin(), exposures.maps()[1].end());
  const Buffer<float> map = torch::tensor(values, torch::kDouble).reshape({3, 4});
  const double step = 1e-3;  // the loss is linear in both: any step does
  for (int k = 0; k < 12; ++k) {
    Buffer<float> up = map.Clone(), down = map.Clone();
    up.view(-1)[k] += step;
    down.view(-1)[k] -= step;
    EXPECT_NEAR(by_map[k], (loss(up, pixels) - loss(down, pixels)) / (2 * step), 1e-4) << k;
  }
  for (int k = 0; k < 168; k += 5) {
    Buffer<float> up = pixels.Clone(), down = pixels.Clone();
    up.view(-1)[k] += step;
    down.view(-1)[k] -= step;
    EXPECT_NEAR(grad.view(-1)[k].item<double>(), (loss(map, up) - loss(map, down)) / (2 * step), 1e-5) << k;
  }
}

TEST(ExposuresTest, PullIsTowardsTheIdentity) {
  Exposures exposures({Gain(1.2f), Gain(0.8f)});
  ExposureGradient gradient{};
  gradient[1] = 5;
  EXPECT_NEAR(exposures.AddPull(0, &gradient), kExposurePull / 2 * 3 * 0.04, 1e-8);
  EXPECT_NEAR(gradient[0], kExposurePull * 0.2, 1e-8);
  EXPECT_EQ(gradient[1], 5);
}

TEST(ExposuresTest, TheGaugeKeepsRatiosAndTheMeanAtTheIdentity) {
  torch::manual_seed(3);
  // Gains relative to the first photograph: the mean is not 1.
  Exposures exposures({Gain(1), Gain(1.5f), Gain(3)});
  EXPECT_NEAR(exposures.maps()[1][0] / exposures.maps()[0][0], 1.5, 1e-5);
  EXPECT_NEAR(exposures.maps()[2][5] / exposures.maps()[0][5], 3, 1e-5);
  const std::vector<ExposureMap> maps = {RandomMap(), RandomMap(), RandomMap(), RandomMap()};
  Exposures mixed(maps);
  for (int i = 0; i < 20; ++i) {
    ExposureGradient gradient;
    for (double& g : gradient) g = torch::randn({1}).item<double>();
    mixed.Step(i % 3, gradient, 0.01);
    ExposureGradient mean{};
    for (const ExposureMap& map : mixed.maps()) {
      for (int k = 0; k < 12; ++k) mean[k] += static_cast<double>(map[k]) / 4;
    }
    for (int k = 0; k < 12; ++k) EXPECT_NEAR(mean[k], static_cast<double>(kIdentityExposure[k]), 1e-6);
  }
  // Where the pictures of two maps meet does not depend on the gauge: shown0 = T(shown1) with T = map0 map1^-1.
  const auto affine = [](const ExposureMap& map) {
    Buffer<float> t = torch::eye(4, torch::kDouble);
    for (int k = 0; k < 12; ++k) t[k / 4][k % 4] = static_cast<double>(map[k]);
    return t;
  };
  const Exposures fixed(maps);
  EXPECT_LE(MaxAbsError(affine(fixed.maps()[0]).matmul(affine(fixed.maps()[1]).inverse()),
                        affine(maps[0]).matmul(affine(maps[1]).inverse())),
            1e-5);
}

TEST(ExposuresTest, SameBitsForAnyNumberOfThreads) {
  torch::manual_seed(4);
  const Buffer<float> image = torch::rand({211, 173, 3}), upstream = torch::randn({211, 173, 3});
  const auto run = [&](int threads) {
    const Threads scope(threads);
    Exposures exposures({Gain(1.1f), Gain(0.9f)});
    return exposures.Backward(0, image, upstream.Clone());
  };
  EXPECT_EQ(run(1), run(4));
}

TEST(ExposuresTest, RefusesMapsThatAreNone) {
  EXPECT_THROW(Exposures({}), ShapeError);
  EXPECT_THROW(Exposures({Gain(std::nanf(""))}), ShapeError);
  EXPECT_THROW(Exposures({Gain(0), Gain(0)}), ShapeError);
  Exposures exposures({Gain(1), Gain(1)});
  EXPECT_THROW(exposures.Restore(Exposures({Gain(1)}).state()), InputError);
  EXPECT_THROW(exposures.Apply(0, torch::rand({4, 4, 3}), torch::rand({4, 3, 3})), ShapeError);
}

/// Photographs of one scene, taken with other exposures.
std::vector<TrainView> Exposed(const std::vector<float>& gains) {
  auto views = Photographs(static_cast<int>(gains.size()));
  for (size_t i = 0; i < gains.size(); ++i) views[i].image *= gains[i];
  return views;
}

TrainOptions WithExposure(int iterations) {
  TrainOptions options = Options(iterations);
  options.exposure = "on";
  options.opacity_reg = options.scale_reg = 0;
  options.refine_start = iterations;
  return options;
}

TEST(TrainerExposureTest, FindsTheGainBetweenPhotographs) {
  Trainer trainer(WithExposure(300), kSeed, {0, 0, 0}, Exposed({1.2f, 0.8f, 1.2f, 0.8f}), Truth());
  const double first = trainer.Step();
  for (int i = 2; i < 300; ++i) trainer.Step();
  EXPECT_LT(trainer.Step(), 0.2 * first);
  const Buffer<float> maps = trainer.exposures();
  ASSERT_EQ(maps.shape(), torch::IntArrayRef({4, 3, 4}));
  // What a map does to a grey of the scene.
  const Buffer<float> grey = torch::tensor({0.5f, 0.5f, 0.5f, 1.f});
  const Buffer<float> shown = maps.matmul(grey);  // [4,3]
  EXPECT_LE(((shown[0] + shown[2]) / (shown[1] + shown[3]) - 1.5).abs().max().item<float>(), 0.06);
}

TEST(TrainerExposureTest, StartsFromTheMapsThatAreGiven) {
  auto views = Exposed({1.2f, 0.8f});
  views[0].exposure = Gain(3);  // the same ratio in another gauge
  views[1].exposure = Gain(2);
  Trainer given(WithExposure(10), kSeed, {0, 0, 0}, views, Truth());
  EXPECT_NEAR(given.Step(), kExposurePull / 2 * 3 * 0.04, 1e-4);
  EXPECT_NEAR(given.exposures()[0][0][0].item<float>(), 1.2, 0.02);
}

TEST(TrainerExposureTest, OffIsAsIfItWereNotThere) {
  auto views = Exposed({1.2f, 0.8f});
  const auto run = [&] {
    Trainer trainer(Options(60), kSeed, {0, 0, 0}, views, Start());
    trainer.Run({}, Silent());
    EXPECT_FALSE(trainer.exposures().defined());
    return Clone(trainer.gaussians());
  };
  const Gaussians plain = run();
  views[0].exposure = Gain(3);
  EXPECT_TRUE(SameBits(run(), plain));
}

TEST(TrainerExposureTest, MaskedPixelsContributeNothing) {
  const auto run = [&](float hidden) {
    auto views = Exposed({1.2f, 0.8f, 1.f});
    for (TrainView& view : views) {
      view.confidence = Buffer<float>::Full({kHeight, kWidth}, 1.f);
      view.confidence.narrow(1, 20, kWidth - 20).SetZero();
      view.image.narrow(1, 20, kWidth - 20).fill_(hidden);
    }
    TrainOptions options = WithExposure(60);
    options.ssim_weight = 0;  // its windows reach across the mask, where they find the same photograph on both sides
    Trainer trainer(options, kSeed, {0, 0, 0}, views, Start());
    trainer.Run({}, Silent());
    return trainer.exposures();
  };
  EXPECT_TRUE(torch::equal(run(0.1f), run(0.9f)));
  // All hidden: only the gauge and the pull are left, which do nothing at the identity.
  auto views = Exposed({1.2f, 0.8f});
  for (TrainView& view : views) view.confidence = Buffer<float>::Zeros({kHeight, kWidth});
  Trainer blind(WithExposure(30), kSeed, {0, 0, 0}, views, Start());
  blind.Run({}, Silent());
  EXPECT_TRUE(torch::equal(blind.exposures()[0], blind.exposures()[1]));
  EXPECT_EQ(blind.exposures()[0][0][0].item<float>(), 1);
}

TEST(TrainerExposureTest, ResumingGivesTheBitsOfAnUninterruptedRun) {
  TempDir dir;
  const auto make = [] { return Trainer(WithExposure(60), kSeed, {0, 0, 0}, Exposed({1.2f, 0.8f, 1.f}), Start()); };
  Trainer whole = make();
  whole.Run({dir.path(), 25, {}}, Silent());
  Trainer resumed = make();
  resumed.Restore(ReadCheckpoint(CheckpointPath(dir.path(), 25)));
  resumed.Run({}, Silent());
  EXPECT_TRUE(SameBits(resumed.gaussians(), whole.gaussians()));
  EXPECT_TRUE(torch::equal(resumed.exposures(), whole.exposures()));
  EXPECT_GT(MaxAbsError(whole.exposures()[0], whole.exposures()[1]), 0.05);
}

TEST(TrainerExposureTest, RefusesACheckpointOfOtherPhotographs) {
  Trainer three(WithExposure(60), kSeed, {0, 0, 0}, Exposed({1.2f, 0.8f, 1.f}), Start());
  Trainer two(WithExposure(60), kSeed, {0, 0, 0}, Exposed({1.2f, 0.8f}), Start());
  Checkpoint checkpoint = three.MakeCheckpoint();
  checkpoint.sampler = two.MakeCheckpoint().sampler;  // which is refused first
  try {
    two.Restore(checkpoint);
    ADD_FAILURE() << "maps of another number of photographs were accepted";
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("exposure maps of 3 photographs, this run has 2"));
  }
  Trainer without(Options(60), kSeed, {0, 0, 0}, Photographs(2), Start());
  EXPECT_THROW(two.Restore(without.MakeCheckpoint()), InputError);
}

}  // namespace
}  // namespace oraclegs
