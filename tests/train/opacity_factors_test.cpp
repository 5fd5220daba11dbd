#include "oraclegs/train/opacity_factors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "support/buffers.h"
#include "support/temp_dir.h"
#include "train/small_scene.h"

namespace oraclegs {
namespace {

Buffer<float> Draw(const OpacityPerturbation& perturbation, int64_t n) {
  const Buffer<float> factors = Buffer<float>::Empty({n});
  DrawOpacityFactors(perturbation, factors);
  return factors;
}

TEST(DropProbabilityTest, GrowsToTheEndButSparesTheLastIteration) {
  EXPECT_EQ(DropProbability(0.2, 0, 1000), 0);
  EXPECT_DOUBLE_EQ(DropProbability(0.2, 500, 1000), 0.1);
  EXPECT_DOUBLE_EQ(DropProbability(0.2, 999, 1000), 0.2 * 0.999);
  EXPECT_EQ(DropProbability(0.2, 1000, 1000), 0);
}

TEST(DrawOpacityFactorsTest, LeavesOutTheShareAndFillsIn) {
  const int64_t n = 100000;
  const Buffer<float> factors = Draw({3, 17, 0.25, 0}, n);
  const float kept = 1 / 0.75f;
  EXPECT_EQ((Flat(factors) == 0 || Flat(factors) == kept).count(), n);
  EXPECT_NEAR(static_cast<double>((Flat(factors) == 0).count()) / n, 0.25, 0.006);  // four sigma
}

TEST(DrawOpacityFactorsTest, NoiseHasItsMomentsAndIsNeverNegative) {
  const int64_t n = 100000;
  const Buffer<float> factors = Draw({3, 17, 0, 0.2}, n);
  EXPECT_NEAR(Wide(factors).mean(), 1, 0.003);
  EXPECT_NEAR(std::sqrt((Wide(factors) - Wide(factors).mean()).square().mean()), 0.2, 0.002);
  EXPECT_NEAR((Wide(factors) - 1).cube().mean() / 0.008, 0, 0.04);  // no skew
  const Buffer<float> wide = Draw({3, 17, 0, 2}, n);
  EXPECT_GE(Flat(wide).minCoeff(), 0);
  EXPECT_NEAR(static_cast<double>((Flat(wide) == 0).count()) / n, 0.3085, 0.006);  // N(0,1) < -1/2
  EXPECT_NEAR(Wide(Draw({3, 17, 0.5, 0.2}, n)).mean(), 1, 0.015);
}

TEST(DrawOpacityFactorsTest, IsAFunctionOfSeedIterationAndIndex) {
  const OpacityPerturbation perturbation{3, 17, 0.3, 0.5};
  const Buffer<float> factors = Draw(perturbation, 10000);
  EXPECT_TRUE(Equal(Draw(perturbation, 5000), factors.Rows(0, 5000)));
  {
    const Threads scope(4);
    EXPECT_TRUE(Equal(Draw(perturbation, 10000), factors));
  }
  EXPECT_FALSE(Equal(Draw({4, 17, 0.3, 0.5}, 10000), factors));
  EXPECT_FALSE(Equal(Draw({3, 18, 0.3, 0.5}, 10000), factors));
}

TEST(DrawOpacityFactorsTest, HasTheSameNumbersForEveryInstructionSet) {
  const OpacityPerturbation perturbation{(uint64_t{7} << 32) + 3, 17, 0.3, 0.5};
  const int64_t n = 1003;  // no multiple of a vector's lanes
  int64_t left_out = 0;
  ForEachTarget([&](int64_t target) {
    const Buffer<float> factors = Draw(perturbation, n);
    for (int64_t i = 0; i < n; ++i) {
      const uint64_t counter = uint64_t{17} << 32 | static_cast<uint64_t>(i);
      const Philox r = Philox::Draw(perturbation.seed, static_cast<uint64_t>(RandomStream::kOpacityFactors), counter);
      const double u = OpenUniform(r.x[1]), v = OpenUniform(r.x[2]);
      const double normal = std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * v);
      const bool drops = static_cast<double>(OpenUniform(r.x[0])) < 0.3;
      ASSERT_NEAR(factors.data()[i], drops ? 0 : std::max(0., 1 + 0.5 * normal) / 0.7, 1e-5) << target << ' ' << i;
      left_out += drops;
    }
  });
  EXPECT_GT(left_out, 0);
}

TEST(DrawOpacityFactorsTest, RefusesWhatIsNoProbability) {
  EXPECT_THROW(Draw({3, 17, 1, 0}, 5), ShapeError);
  EXPECT_THROW(Draw({3, 17, -0.1, 0}, 5), ShapeError);
  EXPECT_THROW(Draw({3, 17, 0, -1}, 5), ShapeError);
}

TrainOptions Perturbed(double dropout, double noise) {
  TrainOptions options = Options(60);
  options.dropout = dropout;
  options.opacity_noise = noise;
  return options;
}

Gaussians Trained(const TrainOptions& options) {
  Trainer trainer(options, kSeed, {0, 0, 0}, Photos(3), Start());
  trainer.Run({}, Silent());
  return trainer.gaussians().Clone();
}

TEST(TrainerPerturbationTest, ChangesTheRunReproducibly) {
  const Gaussians plain = Trained(Perturbed(0, 0));
  for (const auto& [dropout, noise] : {std::pair(0.5, 0.0), std::pair(0.0, 0.5), std::pair(0.5, 0.5)}) {
    const Gaussians perturbed = Trained(Perturbed(dropout, noise));
    EXPECT_FALSE(SameBits(perturbed, plain));
    const Threads scope(3);
    EXPECT_TRUE(SameBits(Trained(Perturbed(dropout, noise)), perturbed));
  }
}

TEST(TrainerPerturbationTest, ResumingGivesTheBitsOfAnUninterruptedRun) {
  TempDir dir;
  const TrainOptions options = Perturbed(0.4, 0.3);
  Trainer whole(options, kSeed, {0, 0, 0}, Photos(3), Start());
  whole.Run({dir.path(), 25, {}}, Silent());
  Trainer resumed(options, kSeed, {0, 0, 0}, Photos(3), Start());
  resumed.Restore(ReadCheckpoint(CheckpointPath(dir.path(), 25)));
  resumed.Run({}, Silent());
  EXPECT_TRUE(SameBits(resumed.gaussians(), whole.gaussians()));
}

TEST(TrainerPerturbationTest, TheLastIterationShowsTheModelAsItIs) {
  TrainOptions options = Perturbed(0.9, 1);
  options.iterations = 1;
  const double perturbed = Trainer(options, kSeed, {0, 0, 0}, Photos(1), Start()).Step();
  options.dropout = options.opacity_noise = 0.;
  EXPECT_EQ(perturbed, Trainer(options, kSeed, {0, 0, 0}, Photos(1), Start()).Step());
}

}  // namespace
}  // namespace oraclegs
