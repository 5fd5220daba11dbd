#include <Eigen/Geometry>
#include <cmath>

#include "oraclegs/core/rng.h"
#include "oraclegs/render/render.h"
#include "oraclegs/train/mcmc.h"
#include "support/buffers.h"
#include "support/golden.h"
#include "train/gaussian_fixtures.h"

namespace oraclegs {
namespace {

constexpr uint64_t kSeed = 0x123456789abcdef0;

/// Identity rotation and unit scales, so that the displacement is the noise itself.
Gaussians UnitGaussians(int64_t n, float logit) {
  Gaussians g = Gaussians::Zeros(n);
  Table(g.quats).col(0).setOnes();
  Flat(g.opacity_logits).setConstant(logit);
  return g;
}

TEST(NoiseTest, MatchesGoldenOnEveryTarget) {
  const SafetensorsFile golden = OpenGolden("mcmc_relocation");
  const double lr = golden.Values<double>("noise_lr_xyz").at(0);
  const Buffer<float> epsilon = GoldenFloat(golden, "noise_epsilon");
  const Eigen::ArrayXd wanted = Wide(GoldenDouble(golden, "noise_displacement"));
  const Eigen::ArrayXd wanted_means = Wide(GoldenDouble(golden, "noise_means_out"));
  ForEachTarget([&](int64_t target) {
    Gaussians g = Gaussians::Zeros(epsilon.size(0));
    g.log_scales = GoldenFloat(golden, "noise_log_scales");
    g.quats = GoldenFloat(golden, "noise_quats");
    g.opacity_logits = GoldenFloat(golden, "noise_opacity_logits");
    AddNoiseFrom(epsilon, lr, &g);
    const Eigen::ArrayXd allowed = 2e-4 * wanted.abs() + 1e-6 * wanted.abs().maxCoeff();
    EXPECT_TRUE(((Wide(g.means) - wanted).abs() <= allowed).all()) << target;
    g.means = GoldenFloat(golden, "noise_means");
    AddNoiseFrom(epsilon, lr, &g);
    const Eigen::ArrayXd rounding = 1e-6 * wanted_means.abs();
    EXPECT_TRUE(((Wide(g.means) - wanted_means).abs() <= allowed + rounding).all()) << target;
  });
}

TEST(NoiseTest, DrawsThePhiloxNumbersOnEveryTarget) {
  constexpr int64_t kCount = 53, kIteration = 77;
  constexpr double kRate = 1e-5;  // 5e5 times this is 5
  constexpr double kPi = 3.14159265358979323846;
  Eigen::ArrayXd wanted(3 * kCount);
  for (int64_t i = 0; i < kCount; ++i) {
    const Philox w = Philox::Draw(kSeed, static_cast<uint64_t>(RandomStream::kNoise), uint64_t{kIteration} << 32 | i);
    const auto uniform = [&](int k) { return (static_cast<double>(w.x[k] >> 8) + 0.5) * 0x1.0p-24; };
    const double r0 = std::sqrt(-2 * std::log(uniform(0))), r1 = std::sqrt(-2 * std::log(uniform(2)));
    wanted[3 * i] = 5 * r0 * std::cos(2 * kPi * uniform(1));
    wanted[3 * i + 1] = 5 * r0 * std::sin(2 * kPi * uniform(1));
    wanted[3 * i + 2] = 5 * r1 * std::cos(2 * kPi * uniform(3));
  }
  const double gate = 1 / (1 + std::exp(-0.5));  // opacity 0
  ForEachTarget([&](int64_t target) {
    Gaussians g = UnitGaussians(kCount, -40);
    AddNoise({kSeed, kIteration, kRate}, &g);
    EXPECT_LT(MaxAbsError(g.means, gate * wanted), 2e-5) << target;
  });
}

TEST(NoiseTest, IsStandardNormal) {
  constexpr int64_t kCount = 100000;
  Gaussians g = UnitGaussians(kCount, -40);
  const double gate = 1 / (1 + std::exp(-0.5));
  AddNoise({1, 9, 1 / (5e5 * gate)}, &g);
  const Eigen::MatrixXd x = Table(g.means).cast<double>();
  EXPECT_LT(x.colwise().mean().cwiseAbs().maxCoeff(), 0.02);
  const Eigen::Matrix3d covariance = x.transpose() * x / kCount;
  EXPECT_LT((covariance - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(), 0.03);
  EXPECT_NEAR(x.array().pow(4).mean(), 3, 0.1);
}

TEST(NoiseTest, MultipliesByTheCovarianceItself) {
  Gaussians g = RandomGaussians(31, 4);
  Flat(g.opacity_logits).setConstant(-40);
  const Eigen::ArrayXd before = Wide(g.means);
  const Buffer<float> epsilon = Buffer<float>::Full({31, 3}, 1.f);
  AddNoiseFrom(epsilon, 1e-6, &g);
  const double gate = 1 / (1 + std::exp(-0.5));
  for (int64_t i = 0; i < 31; ++i) {
    const float* q = g.quats.data() + 4 * i;
    const Eigen::Quaterniond rotation = Eigen::Quaternionf(q[0], q[1], q[2], q[3]).cast<double>().normalized();
    Eigen::Vector3d scale;
    for (int k = 0; k < 3; ++k) scale[k] = std::exp(static_cast<double>(g.log_scales[3 * i + k]));
    const Eigen::Matrix3d r = rotation.toRotationMatrix();
    const Eigen::Vector3d wanted =
        0.5 * gate * (r * scale.cwiseAbs2().asDiagonal() * r.transpose()) * Eigen::Vector3d::Ones();
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(g.means[3 * i + k] - before[3 * i + k], wanted[k], 1e-6);
    }
  }
}

TEST(NoiseTest, TheOpaqueStayWhereTheyAre) {
  Gaussians g = RandomGaussians(100, 4);
  Flat(g.log_scales).setConstant(2);
  Flat(g.opacity_logits).head(99).setZero();  // gate exp(-49.5)
  g.opacity_logits[99] = -6;
  const Buffer<float> before = g.means.Clone();
  AddNoise({1, 9, 1e-4}, &g);
  EXPECT_TRUE(Equal(g.means.Rows(0, 99), before.Rows(0, 99)));
  EXPECT_FALSE(Equal(g.means.Rows(99, 100), before.Rows(99, 100)));
}

TEST(NoiseTest, SameBitsForAnyNumberOfThreads) {
  const auto run = [](int threads) {
    const Threads scope(threads);
    Gaussians g = RandomGaussians(5003, 4);
    AddNoise({1, 9, 1e-4}, &g);
    return g;
  };
  const Gaussians one = run(1);
  EXPECT_TRUE(SameBits(one, run(2)));
  EXPECT_TRUE(SameBits(one, run(5)));
}

TEST(NoiseTest, BlocksGiveTheBitsOfTheWhole) {
  Gaussians whole = RandomGaussians(203, 4), cut = RandomGaussians(203, 4);
  const MeansNoise noise{1, 9, 1e-4};
  AddNoise(noise, &whole);
  AddNoiseToBlock(noise, 64, 203, &cut);
  AddNoiseToBlock(noise, 0, 1, &cut);
  AddNoiseToBlock(noise, 1, 64, &cut);
  EXPECT_TRUE(SameBits(whole, cut));
}

TEST(NoiseTest, IterationAndSeedMatter) {
  const auto run = [](uint64_t seed, int64_t iteration) {
    Gaussians g = UnitGaussians(8, -40);
    AddNoise({seed, iteration, 1e-4}, &g);
    return g.means;
  };
  EXPECT_TRUE(Equal(run(1, 5), run(1, 5)));
  EXPECT_FALSE(Equal(run(1, 5), run(1, 6)));
  EXPECT_FALSE(Equal(run(1, 5), run(2, 5)));
}

TEST(NoiseTest, RefusesEpsilonOfAnotherShape) {
  Gaussians g = RandomGaussians(8, 4);
  EXPECT_THROW(AddNoiseFrom(Buffer<float>::Zeros({7, 3}), 1e-4, &g), ShapeError);
}

TEST(RegularizerTest, AgreesWithAutogradOnEveryTarget) {
  constexpr double kOpacityReg = 0.3, kScaleReg = 0.7;
  for (const int64_t n : {1, 37, 3001}) {
    const Gaussians g = RandomGaussians(n, 8);
    const Eigen::ArrayXd opacity = 1 / (1 + (-Wide(g.opacity_logits)).exp()), scale = Wide(g.log_scales).exp();
    const double value = kOpacityReg * opacity.mean() + kScaleReg * scale.mean();
    const Eigen::ArrayXd by_logit = kOpacityReg * opacity * (1 - opacity) / static_cast<double>(n);
    const Eigen::ArrayXd by_log_scale = kScaleReg * scale / static_cast<double>(3 * n);
    const Gaussians start = RandomGaussians(n, 9);
    ForEachTarget([&](int64_t target) {
      Gaussians grads = start.Clone();
      EXPECT_NEAR(AddRegularizers(g, kOpacityReg, kScaleReg, &grads), value, 1e-6) << target;
      EXPECT_LT(MaxAbsError(Wide(grads.opacity_logits) - Wide(start.opacity_logits), by_logit), 2e-6);
      EXPECT_LT(MaxAbsError(Wide(grads.log_scales) - Wide(start.log_scales), by_log_scale), 2e-6);
      EXPECT_TRUE(Equal(grads.means, start.means) && Equal(grads.sh, start.sh));
      // From zero, the gradient is seen without the rounding of the sum.
      grads = Gaussians::Zeros(n);
      AddRegularizers(g, kOpacityReg, kScaleReg, &grads);
      EXPECT_LT(RelativeL2(grads.opacity_logits, by_logit), 1e-6) << target;
      EXPECT_LT(RelativeL2(grads.log_scales, by_log_scale), 1e-6) << target;
    });
  }
}

TEST(RegularizerTest, BlocksGiveTheBitsOfTheWholeAndMemoryIsReused) {
  Regularizers regularizers;
  for (const int64_t n : {7 * kGradBlock + 5, 2 * kGradBlock, int64_t{3}}) {
    const Gaussians g = RandomGaussians(n, 8);
    Gaussians whole = RandomGaussians(n, 9), cut = RandomGaussians(n, 9);
    const double value = AddRegularizers(g, 0.01, 0.02, &whole);
    regularizers.Begin(g, 0.01, 0.02);
    const int64_t middle = std::min(n, 2 * kGradBlock);
    regularizers.AddTo(middle, n, cut.Rows().From(middle));
    regularizers.AddTo(0, middle, cut.Rows());
    EXPECT_EQ(regularizers.Value(), value);
    EXPECT_TRUE(SameBits(whole, cut));
  }
}

TEST(RegularizerTest, ValueHasTheSameBitsForAnyNumberOfThreads) {
  const Gaussians g = RandomGaussians(50001, 8);
  const auto run = [&](int threads) {
    const Threads scope(threads);
    Gaussians grads = Gaussians::Zeros(g.size());
    return AddRegularizers(g, 0.01, 0.01, &grads);
  };
  const double one = run(1);
  EXPECT_EQ(one, run(2));
  EXPECT_EQ(one, run(5));
}

}  // namespace
}  // namespace oraclegs
