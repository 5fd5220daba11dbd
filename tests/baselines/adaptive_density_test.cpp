#include "oraclegs/baselines/adaptive_density.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "baselines/baseline_trainer.h"
#include "oraclegs/camera/scene_bounds.h"
#include "oraclegs/train/train_device.h"
#include "oraclegs/train/train_math.h"
#include "support/buffers.h"
#include "support/errors.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

/// n opaque Gaussians of one size, apart from each other.
Gaussians Row(int64_t n, double scale) {
  Gaussians g = RandomGaussians(n, 5);
  for (int64_t i = 0; i < n; ++i) g.means[3 * i] = static_cast<float>(10 * i);
  Flat(g.log_scales).setConstant(static_cast<float>(std::log(scale)));
  g.opacity_logits.SetZero();
  return g;
}

Adam Moments(int64_t n) {
  Adam adam(n);
  adam.m = RandomGaussians(n, 91);
  adam.v = RandomGaussians(n, 92);
  return adam;
}

DensityControl Control(double extent = 1) {
  DensityControl control{3, 600, 0.0002, extent, 1000};
  return control;
}

TEST(ControlDensity, ClonesWhatIsSmallAndPulledAt) {
  Gaussians g = Row(3, 0.005);
  Adam adam = Moments(3);
  const Gaussians before = g.Clone();
  const Gaussians m = adam.m.Clone();
  const DensityChange change = ControlDensity(Control(), {0.0001f, 0.0003f, 0}, &g, &adam);
  EXPECT_EQ(change.cloned, 1);
  EXPECT_EQ(change.split, 0);
  EXPECT_EQ(change.removed, 0);
  ASSERT_EQ(g.size(), 4);
  EXPECT_TRUE(Equal(g.means.Rows(0, 3), before.means));
  EXPECT_TRUE(Equal(g.means.Rows(3, 4), before.means.Rows(1, 2)));
  EXPECT_TRUE(Equal(g.sh.Rows(3, 4), before.sh.Rows(1, 2)));
  EXPECT_TRUE(Equal(g.log_scales.Rows(3, 4), before.log_scales.Rows(1, 2)));
  EXPECT_TRUE(Equal(adam.m.sh.Rows(0, 3), m.sh)) << "the original keeps its moments";
  EXPECT_EQ(Flat(adam.m.sh.Rows(3, 4)).abs().maxCoeff(), 0);
  EXPECT_EQ(Flat(adam.v.means.Rows(3, 4)).abs().maxCoeff(), 0);
}

TEST(ControlDensity, SplitsWhatIsLargeIntoTwoOfItsOwnDensity) {
  Gaussians g = Row(2, 0.5);
  Adam adam = Moments(2);
  const Gaussians before = g.Clone();
  const DensityChange change = ControlDensity(Control(), {0, 0.0003f}, &g, &adam);
  EXPECT_EQ(change.split, 1);
  ASSERT_EQ(g.size(), 3);
  EXPECT_TRUE(Equal(g.means.Rows(0, 1), before.means.Rows(0, 1)));
  for (int64_t half : {1, 2}) {
    EXPECT_NEAR(g.log_scales[3 * half], std::log(0.5 / 1.6), 1e-6);
    EXPECT_TRUE(Equal(g.quats.Rows(half, half + 1), before.quats.Rows(1, 2)));
    EXPECT_EQ(g.opacity_logits[half], 0);
  }
  EXPECT_FALSE(Equal(g.means.Rows(1, 2), g.means.Rows(2, 3)));
}

TEST(ControlDensity, HalvesAreDrawnFromTheGaussian) {
  constexpr int64_t kMany = 4000;
  Gaussians g = Row(kMany, 1);
  for (int64_t i = 0; i < kMany; ++i) {  // along y after a quarter turn about z
    g.log_scales[3 * i] = std::log(2.f), g.log_scales[3 * i + 1] = std::log(0.5f);
    g.quats[4 * i] = g.quats[4 * i + 3] = 1, g.quats[4 * i + 1] = g.quats[4 * i + 2] = 0;
  }
  g.means.SetZero();
  Adam adam(kMany);
  DensityControl control = Control();
  control.max_gaussians = 2 * kMany;
  ControlDensity(control, std::vector<float>(kMany, 1.f), &g, &adam);
  ASSERT_EQ(g.size(), 2 * kMany);
  double squares[3] = {};
  for (int64_t i = 0; i < g.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) squares[axis] += std::pow(static_cast<double>(g.means[3 * i + axis]), 2);
  }
  EXPECT_NEAR(std::sqrt(squares[0] / (2 * kMany)), 0.5, 0.02);  // 3 sigma
  EXPECT_NEAR(std::sqrt(squares[1] / (2 * kMany)), 2, 0.06);
  EXPECT_NEAR(std::sqrt(squares[2] / (2 * kMany)), 1, 0.03);
}

TEST(ControlDensity, RemovesTheTransparentAndLaterTheLarge) {
  Gaussians g = Row(3, 0.005);
  g.opacity_logits[0] = static_cast<float>(std::log(0.004 / 0.996));
  Flat(g.log_scales.Rows(2, 3)).setConstant(std::log(0.2f));
  Gaussians late = g.Clone();
  Adam adam = Moments(3), late_adam = Moments(3);
  EXPECT_EQ(ControlDensity(Control(), {0, 0, 0}, &g, &adam).removed, 1);
  EXPECT_EQ(g.size(), 2);
  DensityControl control = Control();
  control.removes_large = true;
  EXPECT_EQ(ControlDensity(control, {0, 0, 0}, &late, &late_adam).removed, 2);
  ASSERT_EQ(late.size(), 1);
  EXPECT_EQ(late.means[0], 10);
  EXPECT_EQ(late_adam.m.size(), 1);
}

TEST(ControlDensity, LeavesTheFaintAndSplitsTheIsolatedWhereAsked) {
  const std::vector<float> pulled = {0.0003f, 0.0003f, 0, 0};
  const auto grow = [&](const DensityControl& control) {
    Gaussians g = Row(4, 2);  // 10 apart: mean squared distances from 200 on
    Flat(g.opacity_logits.Rows(0, 1)).setConstant(static_cast<float>(LogitOf(0.05)));
    Adam adam = Moments(4);
    return ControlDensity(control, pulled, &g, &adam);
  };
  DensityControl control = Control();
  EXPECT_EQ(grow(control).split, 2);
  control.opacity_to_grow = 0.1;
  EXPECT_EQ(grow(control).split, 1);
  control.splits_isolated = true;
  EXPECT_EQ(grow(control).split, 4) << "all are isolated in a scene of extent 1, the faint one as well";
  control.extent = 2.5;
  EXPECT_EQ(grow(control).split, 1) << "none is larger than the extent";
  control.least_opacity = 0.06;
  EXPECT_EQ(grow(control).removed, 1);
}

TEST(ControlDensity, NeverRemovesAllAndNeverExceedsTheMost) {
  Gaussians none = Row(2, 0.005);
  Flat(none.opacity_logits).setConstant(-9);
  none.opacity_logits[1] = -8;
  Adam adam = Moments(2);
  ControlDensity(Control(), {0, 0}, &none, &adam);
  ASSERT_EQ(none.size(), 1);
  EXPECT_EQ(none.opacity_logits[0], -8);

  Gaussians g = Row(4, 0.005);
  adam = Moments(4);
  DensityControl control = Control();
  control.max_gaussians = 5;
  EXPECT_EQ(ControlDensity(control, {1, 3, 2, 3}, &g, &adam).cloned, 1);
  ASSERT_EQ(g.size(), 5);
  EXPECT_EQ(g.means[12], 10) << "the first of those pulled at hardest";
}

TEST(ControlDensity, GrowsAsToldBeforeTheTransparentAreRemoved) {
  Gaussians g = Row(3, 0.5);
  Adam adam = Moments(3);
  const DensityChange change = ControlDensity(Control(), {1, 0, 0}, &g, &adam, [](Gaussians* all, Adam* moments) {
    ASSERT_EQ(all->size(), 4) << "the halves are there, their whole is not";
    KeepRows({0, 1, 2, 3, 3}, all, moments);
    all->opacity_logits[0] = -9;
  });
  EXPECT_EQ(change.split, 1);
  EXPECT_EQ(change.removed, 1);
  ASSERT_EQ(g.size(), 4);
  EXPECT_TRUE(Equal(g.means.Rows(2, 3), g.means.Rows(3, 4)));
  EXPECT_EQ(adam.m.size(), 4);
}

TEST(ControlDensity, RefusesGradientsOfOthers) {
  Gaussians g = Row(3, 0.005);
  Adam adam = Moments(3);
  EXPECT_THROW(ControlDensity(Control(), {0, 0}, &g, &adam), ShapeError);
}

TEST(ResetOpacities, LowersThemAndForgetsTheirMoments) {
  Gaussians g = Row(2, 1);
  g.opacity_logits[1] = -7;
  Adam adam = Moments(2);
  const Buffer<float> means = adam.m.means.Clone();
  ResetOpacities(0.05, &g, &adam);
  EXPECT_NEAR(1 / (1 + std::exp(-g.opacity_logits[0])), 0.05, 1e-6);
  EXPECT_EQ(g.opacity_logits[1], -7);
  EXPECT_EQ(Flat(adam.m.opacity_logits).abs().maxCoeff() + Flat(adam.v.opacity_logits).abs().maxCoeff(), 0);
  EXPECT_TRUE(Equal(adam.m.means, means));
}

BaselineSetup Adaptive(int iterations, int photos = 3) {
  TrainOptions options = Options(iterations);
  options.opacity_reg = options.scale_reg = 0;
  options.largest_scale = 0;
  options.max_gaussians = 500;
  BaselineSetup setup = SmallSetup(options, Photos(photos));
  setup.baseline.adaptive = true;
  setup.baseline.opacity_reset = 60;
  return setup;
}

TEST(TrainerAdaptiveTest, GrowsWherePhotosPullAndTheSameForAnyThreads) {
  const auto train = [] {
    Trainer trainer = BaselineTrainer(Adaptive(100));
    trainer.Run({}, Silent());
    return trainer.gaussians().Clone();
  };
  const Gaussians trained = train();
  EXPECT_GT(trained.size(), 80);
  EXPECT_LE(trained.size(), 500);
  const Threads scope(3);
  EXPECT_TRUE(SameBits(train(), trained));
}

TEST(TrainerAdaptiveTest, LargeIsATenthOfTheCamerasExtent) {
  const auto left = [](double share, bool keep_large) {
    BaselineSetup setup = Adaptive(60);
    setup.baseline.opacity_reset = 30, setup.baseline.opacity_reset_first = 1000;
    setup.baseline.densify_gradient = 1, setup.baseline.keep_large = keep_large;
    Gaussians& start = setup.start;
    Flat(start.opacity_logits).setConstant(1);
    const double extent = SpatialExtent({CameraOnCircle(0), CameraOnCircle(0.3), CameraOnCircle(0.6)});
    Flat(start.log_scales).setConstant(-5);
    Flat(start.log_scales.Rows(0, 1)).setConstant(static_cast<float>(std::log(share * extent)));
    start.means[0] = 50;  // nobody sees it, and nothing moves it
    Trainer trainer = BaselineTrainer(std::move(setup));
    for (int i = 0; i < 40; ++i) trainer.Step();
    return trainer.gaussians().size();
  };
  EXPECT_EQ(left(0.095, false), 60);
  EXPECT_EQ(left(0.105, false), 59);
  EXPECT_EQ(left(0.105, true), 60);
}

TEST(TrainerAdaptiveTest, AnIterationThatRefinesTakesNoStep) {
  BaselineSetup setup = Adaptive(60);
  setup.baseline.densify_gradient = 1, setup.baseline.keep_large = true, setup.baseline.opacity_reset = 0;
  Flat(setup.start.opacity_logits).setConstant(1);
  Trainer trainer = BaselineTrainer(std::move(setup));
  for (int i = 0; i < 39; ++i) trainer.Step();
  const Gaussians before = trainer.gaussians().Clone();
  trainer.Step();
  EXPECT_TRUE(SameBits(trainer.gaussians(), before));
  trainer.Step();
  EXPECT_FALSE(SameBits(trainer.gaussians(), before));
}

/// The largest opacity after each of the first iterations.
std::vector<float> MostOpacity(BaselineSetup setup, std::array<float, 3> background, int iterations) {
  setup.background = background;
  Trainer trainer = BaselineTrainer(std::move(setup));
  std::vector<float> most{0};
  for (int i = 1; i <= iterations; ++i) {
    trainer.Step();
    most.push_back(Flat(trainer.gaussians().opacity_logits).maxCoeff());
  }
  return most;
}

TEST(TrainerAdaptiveTest, OpacitiesAreResetWhenItIsTime) {
  const auto reset = static_cast<float>(LogitOf(0.01));
  BaselineSetup setup = Adaptive(100, 1);
  setup.baseline.opacity_reset = 20;
  std::vector<float> most = MostOpacity(setup, {0, 0, 0}, 45);
  for (int i = 1; i <= 45; ++i) EXPECT_EQ(most[static_cast<size_t>(i)] == reset, i == 20 || i == 40) << i;
  setup.baseline.opacity_reset_first = 7;
  most = MostOpacity(setup, {1, 1, 1}, 35);
  for (int i = 1; i <= 35; ++i) EXPECT_EQ(most[static_cast<size_t>(i)] == reset, i == 7 || i == 27) << i;
  setup.baseline.opacity_reset_first = {};
  most = MostOpacity(setup, {1, 1, 1}, 35);
  for (int i = 1; i <= 35; ++i) EXPECT_EQ(most[static_cast<size_t>(i)] == reset, i == 20 || i == 30) << i;
}

TEST(TrainerAdaptiveTest, ResumingBetweenRefinementsGivesTheBitsOfAnUninterruptedRun) {
  TempDir dir;
  Trainer whole = BaselineTrainer(Adaptive(90));
  whole.Run({dir.path(), 45, {}}, Silent());
  Trainer resumed = BaselineTrainer(Adaptive(90));
  const Checkpoint checkpoint = ReadCheckpoint(CheckpointPath(dir.path(), 45));
  EXPECT_GT(Flat(checkpoint.state.arrays.at("screen_views")).maxCoeff(), 0);
  resumed.Restore(checkpoint);
  resumed.Run({}, Silent());
  EXPECT_TRUE(SameBits(resumed.gaussians(), whole.gaussians()));
}

TEST(TrainerAdaptiveTest, DoesNotGoOnFromAnotherDensification) {
  TrainSetup setup = Adaptive(90);
  const Trainer mcmc(std::move(setup), OnTheCpu);
  Trainer trainer = BaselineTrainer(Adaptive(90));
  EXPECT_THAT(MessageOf<InputError>([&] { trainer.Restore(mcmc.MakeCheckpoint()); }),
              testing::HasSubstr("holds no state 'screen_gradients' of this training; start anew with --overwrite"));
}

template <class F>
std::vector<int> IterationsWhere(const F& holds) {
  std::vector<int> iterations;
  for (int i = 1; i <= 110; ++i) {
    if (holds(i)) iterations.push_back(i);
  }
  return iterations;
}

TEST(ResetsOpacities, AtTheFirstAndRegularlyAfterIt) {
  TrainOptions options;
  options.iterations = 100;
  options.refine_start = 30, options.refine_every = 10, options.refine_stop = 0.7;
  BaselineSettings settings;
  settings.opacity_reset = 25;
  const auto black = [&](int i) { return ResetsOpacities(settings, options, false, i); };
  const auto white = [&](int i) { return ResetsOpacities(settings, options, true, i); };
  EXPECT_THAT(IterationsWhere(black), testing::ElementsAre(25, 50));
  EXPECT_THAT(IterationsWhere(white), testing::ElementsAre(25, 30, 50));
  settings.opacity_reset_first = 6;
  EXPECT_THAT(IterationsWhere(white), testing::ElementsAre(6, 31, 56));
  settings.opacity_reset = 0;
  EXPECT_TRUE(IterationsWhere(white).empty());
}

}  // namespace
}  // namespace oraclegs
