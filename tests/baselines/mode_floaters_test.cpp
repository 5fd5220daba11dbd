#include "oraclegs/baselines/mode_floaters.h"
#include "baselines/baseline_trainer.h"
#include "support/temp_dir.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <cmath>

#include "train/gaussian_fixtures.h"

namespace oraclegs {
namespace {

/// Looks along z, 48 x 48 pixels.
Camera Square() { return {48, 48, 48, 48, 24, 24, Eigen::Isometry3d::Identity()}; }

/// A wall at z = 8 of 24 x 24 opaque Gaussians, and last in the list a floater before it, at z = 2, which covers about
/// 4 x 4 pixels.
Gaussians WallAndFloater(float opacity) {
  constexpr int kSide = 24;
  Gaussians g = RandomGaussians(kSide * kSide + 1, 1);
  for (int i = 0; i <= kSide * kSide; ++i) {
    const bool wall = i < kSide * kSide;
    const float step = 8.f / kSide;
    const float mean[3] = {wall ? -4 + step * (static_cast<float>(i % kSide) + 0.5f) : 0.3f,
                           wall ? -4 + step * (static_cast<float>(i / kSide) + 0.5f) : 0.2f, wall ? 8.f : 2.f};
    std::copy(mean, mean + 3, g.means.data() + 3 * i);
    std::fill_n(g.log_scales.data() + 3 * i, 3, std::log(wall ? 0.25f : 0.05f));
    g.opacity_logits[i] = wall ? 3.f : std::log(opacity / (1 - opacity));
  }
  return g;
}

TEST(ModeDifferences, AreRelative) {
  RayModes modes;
  modes.blended_depth = {4, 4, 4, 4, 4, 4, 4, 4, 4, 0};
  modes.mode_depth = {4, 3, 5, 4, 4, 4, 4, 4, 4, 0};
  // Mean 3.6, deviation 1.265: mean - 3 deviations is below 0, the least depth.
  const std::vector<float> differences = ModeDifferences(modes);
  EXPECT_EQ(differences, (std::vector<float>{0, 0.25f, -0.25f, 0, 0, 0, 0, 0, 0, 0}));
  modes.blended_depth.back() = 4;
  EXPECT_EQ(ModeDifferences(modes)[1], 0.125f);  // (4 - 3) / (4 + 4)
}

TEST(FloaterPercentile, FallsWithTheDip) {
  const ModeFloaterOptions options;
  EXPECT_EQ(FloaterPercentile(0, options), 98);
  EXPECT_NEAR(FloaterPercentile(0.01, options), 98 * std::exp(-0.075), 1e-12);
  EXPECT_EQ(FloaterPercentile(0.2, options), 80);
}

TEST(FindModeFloaters, FindsWhatHangsBeforeTheWall) {
  const Gaussians g = WallAndFloater(0.6f);
  const std::vector<uint8_t> floaters = FindModeFloaters(g, {Square()}, {}, {});
  ASSERT_EQ(floaters.size(), 577U);
  EXPECT_EQ(floaters.back(), 1);
  EXPECT_EQ(std::count(floaters.begin(), floaters.end(), 1), 1);
}

TEST(FindModeFloaters, SparesWhatIsNoMode) {
  // Of weight below that of the wall behind it: it is not the mode of any pixel.
  const std::vector<uint8_t> floaters = FindModeFloaters(WallAndFloater(0.2f), {Square()}, {}, {});
  EXPECT_EQ(floaters.back(), 0);
}

TEST(FindModeFloaters, JoinsViewsForAnyNumberOfThreads) {
  Gaussians g = RandomGaussians(2000, 4);
  Table(g.means).col(2) += 6;
  Camera right = Square();
  right.cam_from_world.translation().x() = -1;
  const auto run = [&](const std::vector<Camera>& cameras, int threads) {
    const Threads scope(threads);
    return FindModeFloaters(g, cameras, {}, {});
  };
  const auto both = run({Square(), right}, 1);
  EXPECT_EQ(run({Square(), right}, 3), both);
  EXPECT_GT(std::count(both.begin(), both.end(), 1), 10);
  EXPECT_LT(std::count(both.begin(), both.end(), 1), 1500);
  EXPECT_EQ(run({}, 1), std::vector<uint8_t>(2000, 0));
}

constexpr int kWallSide = 20;

/// Looks along z, from a little to the side.
Camera BeforeTheWall(double x) {
  Camera camera{40, 40, 40, 40, 20, 20, Eigen::Isometry3d::Identity()};
  camera.cam_from_world.translation().x() = -x;
  return camera;
}

/// A white wall at z = 8, and with `floaters` two black Gaussians that hang before it, at z = 2, last in the list.
Gaussians Wall(bool floaters) {
  const int wall = kWallSide * kWallSide, count = wall + (floaters ? 2 : 0);
  Gaussians g = RandomGaussians(count, 1);
  g.sh.SetZero();
  constexpr float kStep = 8.f / kWallSide;
  for (int i = 0; i < count; ++i) {
    const bool is_wall = i < wall;
    const float mean[3] = {is_wall ? -4 + kStep * (static_cast<float>(i % kWallSide) + 0.5f) : 0.3f,
                           is_wall ? -4 + kStep * (static_cast<float>(i / kWallSide) + 0.5f) : 0.5f * (i - wall),
                           is_wall ? 8.f : 2.f};
    std::copy(mean, mean + 3, g.means.data() + 3 * i);
    std::fill_n(g.log_scales.data() + 3 * i, 3, std::log(is_wall ? 0.3f : 0.06f));
    g.opacity_logits[i] = is_wall ? 3.f : 0.5f;
    std::fill_n(g.sh.data() + 48 * i, 3, is_wall ? 1.5f : -3.f);
  }
  return g;
}

Buffer<float> SeenFrom(const Gaussians& gaussians, double x) {
  return MakeRasterizer(kCpu)->Forward(gaussians, BeforeTheWall(x), {}, RenderPass::kInference).image.Clone();
}

BaselineSetup WallSetup(int at, int iterations = 60) {
  TrainOptions options = Options(iterations);
  options.refine_start = 5;  // refines at 10, 20, ...
  options.opacity_reg = options.scale_reg = options.largest_scale = 0;
  options.max_gaussians = 1000;
  std::vector<TrainView> photos;
  for (const double x : {0., 0.4}) {
    photos.push_back({"photo", BeforeTheWall(x), SeenFrom(Wall(false), x), {}});
  }
  BaselineSetup setup = SmallSetup(options, photos, Wall(true));
  setup.baseline.prune_modes_at = at;
  setup.baseline.adaptive = true;
  setup.baseline.opacity_reset = 0;
  setup.baseline.densify_gradient = 1;  // nothing is cloned
  return setup;
}

TEST(PruneModes, MakesFloatersInvisibleAndNothingElse) {
  PruneModes part(WallSetup(30));
  TrainedModel model{Wall(true), Adam(kWallSide * kWallSide + 2)};
  for (Gaussians* moments : {&model.adam.m, &model.adam.v}) Flat(moments->opacity_logits).setConstant(0.5f);
  PartGradients grads;
  Iteration iteration;
  iteration.number = 29;
  part.BeforeView(iteration, &model, &grads);
  EXPECT_TRUE(SameBits(model.gaussians, Wall(true)));
  iteration.number = 30;
  EXPECT_EQ(part.BeforeView(iteration, &model, &grads), 0);
  Gaussians expected = Wall(true);
  Flat(expected.opacity_logits).tail(2).setConstant(kRemovedLogit);
  EXPECT_TRUE(SameBits(model.gaussians, expected));
  for (const Gaussians* moments : {&model.adam.m, &model.adam.v}) {
    EXPECT_EQ((Flat(moments->opacity_logits) == 0).count(), 2);
    EXPECT_EQ(moments->opacity_logits[kWallSide * kWallSide], 0);
  }
  for (const double x : {0., 0.4}) {
    EXPECT_GT(MaxAbsError(SeenFrom(Wall(true), x), SeenFrom(Wall(false), x)), 0.2);
    EXPECT_TRUE(SameBytes(SeenFrom(model.gaussians, x), SeenFrom(Wall(false), x)));
  }
}

TEST(PruneModes, TakesThemOutOfTheModelWithTheNextRefinement) {
  Trainer trainer = BaselineTrainer(WallSetup(3));
  const int64_t all = kWallSide * kWallSide + 2;
  while (trainer.iteration() < 2) trainer.Step();
  EXPECT_GT(Flat(trainer.gaussians().opacity_logits).minCoeff(), -5);
  const auto removed = [&] { return (Flat(trainer.gaussians().opacity_logits) == kRemovedLogit).count(); };
  trainer.Step();
  const int64_t found = removed();
  EXPECT_TRUE((Flat(trainer.gaussians().opacity_logits).tail(2) == kRemovedLogit).all());
  EXPECT_LT(found, all / 2);
  while (trainer.iteration() < 9) trainer.Step();
  EXPECT_EQ(trainer.gaussians().size(), all);
  EXPECT_EQ(removed(), found) << "no gradient moves them";
  trainer.Step();
  EXPECT_EQ(trainer.gaussians().size(), all - found);
  EXPECT_GT(Flat(trainer.gaussians().opacity_logits).minCoeff(), -5);
}

TEST(PruneModes, GivesTheSameBitsForAnyNumberOfThreadsAndResumed) {
  TempDir dir;
  Trainer whole = BaselineTrainer(WallSetup(35));
  whole.Run({dir.path(), 33, {}}, Silent());
  const Threads scope(3);
  Trainer threads = BaselineTrainer(WallSetup(35));
  threads.Run({}, Silent());
  EXPECT_TRUE(SameBits(threads.gaussians(), whole.gaussians()));
  Trainer resumed = BaselineTrainer(WallSetup(35));
  resumed.Restore(ReadCheckpoint(CheckpointPath(dir.path(), 33)));
  resumed.Run({}, Silent());
  EXPECT_TRUE(SameBits(resumed.gaussians(), whole.gaussians()));
  EXPECT_LT(whole.gaussians().size(), kWallSide * kWallSide + 2);
}

}  // namespace

}  // namespace oraclegs
