#include "oraclegs/train/noise.h"

#include <Eigen/Geometry>
#include <cmath>

#include "oraclegs/core/rng.h"
#include "oraclegs/render/render.h"
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

TEST(Noise, MatchesGoldenOnEveryTarget) {
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

TEST(Noise, DrawsPhiloxNumbersOnEveryTarget) {
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

TEST(Noise, IsStandardNormal) {
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

TEST(Noise, MultipliesByTheCovarianceItself) {
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

TEST(Noise, LeavesOpaqueGaussiansInPlace) {
  Gaussians g = RandomGaussians(100, 4);
  Flat(g.log_scales).setConstant(2);
  Flat(g.opacity_logits).head(99).setZero();  // gate exp(-49.5)
  g.opacity_logits[99] = -6;
  const Buffer<float> before = g.means.Clone();
  AddNoise({1, 9, 1e-4}, &g);
  EXPECT_TRUE(Equal(g.means.Rows(0, 99), before.Rows(0, 99)));
  EXPECT_FALSE(Equal(g.means.Rows(99, 100), before.Rows(99, 100)));
}

TEST(Noise, GivesTheSameBitsForAnyNumberOfThreads) {
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

TEST(Noise, GivesTheSameBitsInBlocks) {
  Gaussians whole = RandomGaussians(203, 4), cut = RandomGaussians(203, 4);
  const MeansNoise noise{1, 9, 1e-4};
  AddNoise(noise, &whole);
  AddNoiseToBlock(noise, 64, 203, &cut);
  AddNoiseToBlock(noise, 0, 1, &cut);
  AddNoiseToBlock(noise, 1, 64, &cut);
  EXPECT_TRUE(SameBits(whole, cut));
}

TEST(Noise, DependsOnIterationAndSeed) {
  const auto run = [](uint64_t seed, int64_t iteration) {
    Gaussians g = UnitGaussians(8, -40);
    AddNoise({seed, iteration, 1e-4}, &g);
    return g.means;
  };
  EXPECT_TRUE(Equal(run(1, 5), run(1, 5)));
  EXPECT_FALSE(Equal(run(1, 5), run(1, 6)));
  EXPECT_FALSE(Equal(run(1, 5), run(2, 5)));
}

TEST(Noise, RefusesEpsilonOfAnotherShape) {
  Gaussians g = RandomGaussians(8, 4);
  EXPECT_THROW(AddNoiseFrom(Buffer<float>::Zeros({7, 3}), 1e-4, &g), ShapeError);
}

}  // namespace
}  // namespace oraclegs
