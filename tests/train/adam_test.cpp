#include "oraclegs/train/adam.h"

#include <gtest/gtest.h>

#include <cmath>

#include "train/gaussian_fixtures.h"

namespace oraclegs {
namespace {

constexpr double kBeta1 = 0.9, kBeta2 = 0.999, kEpsilon = 1e-15;

/// The textbook in double, one tensor.
struct SlowAdam {
  Buffer<float> p, m, v;
  explicit SlowAdam(const Buffer<float>& start)
      : p(start.to(torch::kDouble)), m(torch::zeros_like(p)), v(torch::zeros_like(p)) {}
  void Step(const Buffer<float>& grad, const Buffer<float>& rate, int64_t t) {
    const Buffer<float> g = grad.to(torch::kDouble);
    m = kBeta1 * m + (1 - kBeta1) * g;
    v = kBeta2 * v + (1 - kBeta2) * g * g;
    const double t_double = static_cast<double>(t);
    const Buffer<float> m_hat = m / (1 - std::pow(kBeta1, t_double)), v_hat = v / (1 - std::pow(kBeta2, t_double));
    p = p - rate * m_hat / (v_hat.sqrt() + kEpsilon);
  }
};

/// Gradients of very different size, some exactly zero, with garbage above the active degree.
Gaussians RandomGrads(int64_t n, uint64_t seed, int degree) {
  Gaussians g = RandomGaussians(n, seed);
  g.ForEach(
      [](const char*, Buffer<float>& t) { t = t * torch::pow(10.f, -3 * t.abs()) * (t.abs() > 0.1f).to(torch::kFloat); });
  g.sh.narrow(1, ShCount(degree), kShCoefficients - ShCount(degree)).fill_(std::nanf(""));
  return g;
}

std::vector<Buffer<float>> RateOf(const LearningRates& r) {
  Buffer<float> sh = torch::full({1, 16, 3}, r.sh_rest, torch::kDouble);
  sh.narrow(1, 0, 1).fill_(r.sh0);
  const auto scalar = [](double x) { return torch::tensor(x, torch::kDouble); };
  return {scalar(r.means), scalar(r.log_scales), scalar(r.quats), scalar(r.opacity_logits), sh};
}

class AdamDegreeTest : public testing::TestWithParam<int> {};

TEST_P(AdamDegreeTest, AgreesWithDoublePrecisionOnEveryTarget) {
  const int degree = GetParam();
  LearningRates rates;
  rates.means = 3e-3;
  const auto rate = RateOf(rates);
  ForEachTarget([&](int64_t target) {
    for (const int64_t n : {1, 5, 37}) {  // no size is a whole number of vectors
      const Gaussians start = RandomGaussians(n, 1);
      Gaussians params = Copy(start);
      Adam adam(n);
      std::vector<SlowAdam> slow;
      for (const Buffer<float>& t : Tensors(start)) slow.emplace_back(t);
      for (int64_t step = 1; step <= 6; ++step) {
        const Gaussians grads = RandomGrads(n, 100 + step, degree);
        adam.Step(grads, rates, degree, &params);
        const auto g = Tensors(grads);
        for (size_t k = 0; k < g.size(); ++k) slow[k].Step(torch::nan_to_num(g[k], 0), rate[k], step);
      }
      const auto p = Tensors(params), m = Tensors(adam.m), v = Tensors(adam.v);
      for (size_t k = 0; k < p.size(); ++k) {
        EXPECT_TRUE(torch::allclose(p[k].to(torch::kDouble), slow[k].p, 1e-6, 1e-6)) << target << " tensor " << k;
        EXPECT_TRUE(torch::allclose(m[k].to(torch::kDouble), slow[k].m, 1e-5, 1e-8)) << target << " tensor " << k;
        EXPECT_TRUE(torch::allclose(v[k].to(torch::kDouble), slow[k].v, 1e-5, 1e-15)) << target << " tensor " << k;
      }
      const int active = ShCount(degree);
      EXPECT_TRUE(torch::equal(params.sh.narrow(1, active, 16 - active), start.sh.narrow(1, active, 16 - active)));
    }
  });
}

INSTANTIATE_TEST_SUITE_P(Degrees, AdamDegreeTest, testing::Range(0, 4));

TEST(AdamTest, SameBitsForAnyNumberOfThreads) {
  constexpr int64_t kCount = 13001;
  const auto run = [&](int threads) {
    const Threads scope(threads);
    Gaussians params = RandomGaussians(kCount, 1);
    Adam adam(kCount);
    for (int step = 0; step < 3; ++step) adam.Step(RandomGaussians(kCount, 10 + step), {1e-3}, 2, &params);
    return params;
  };
  const Gaussians one = run(1);
  EXPECT_TRUE(SameBits(one, run(2)));
  EXPECT_TRUE(SameBits(one, run(5)));
}

TEST(AdamTest, BlocksGiveTheBitsOfTheWhole) {
  constexpr int64_t kCount = 203;
  Gaussians whole = RandomGaussians(kCount, 1), cut = RandomGaussians(kCount, 1);
  Adam adam(kCount), cut_adam(kCount);
  for (int round = 0; round < 3; ++round) {
    const Gaussians grads = RandomGaussians(kCount, 10 + round);
    adam.Step(grads, {1e-3}, 2, &whole);
    const AdamStep step = cut_adam.BeginStep({1e-3}, 2, &cut);
    for (const auto& [begin, end] : std::vector<std::pair<int64_t, int64_t>>{{64, 203}, {0, 1}, {1, 64}}) {
      step.Update(begin, end, grads.Rows().From(begin));
    }
  }
  EXPECT_EQ(cut_adam.step, 3);
  EXPECT_TRUE(SameBits(whole, cut));
  EXPECT_TRUE(SameBits(adam.v, cut_adam.v));
}

TEST(AdamTest, FirstStepMovesByTheLearningRate) {
  // m_hat / sqrt(v_hat) is the sign of the gradient in the first step, whatever its size.
  Gaussians params = Gaussians::Zeros(3);
  Gaussians grads = Gaussians::Zeros(3);
  grads.ForEach([](const char*, Buffer<float>& t) { t.fill_(-1e-6f); });
  LearningRates rates;
  rates.means = 0.125;
  Adam adam(3);
  adam.Step(grads, rates, 3, &params);
  EXPECT_EQ(adam.step, 1);
  const auto rate = RateOf(rates);
  const auto p = Tensors(params);
  for (size_t k = 0; k < p.size(); ++k) {
    EXPECT_TRUE(torch::allclose(p[k].to(torch::kDouble), rate[k].expand_as(p[k]), 1e-5, 0));
  }
}

TEST(AdamTest, MomentsOfTheForgottenEndAtZero) {
  Gaussians params = Gaussians::Zeros(2), grads = Gaussians::Zeros(2);
  grads.means.fill_(1e-10f);
  Adam adam(2);
  adam.Step(grads, {}, 3, &params);
  grads.means.SetZero();
  for (int step = 0; step < 1000; ++step) adam.Step(grads, {}, 3, &params);
  EXPECT_EQ(adam.m.means.abs().max().item<float>(), 0);
}

TEST(AdamTest, RefusesWhatDoesNotFit) {
  Gaussians params = Gaussians::Zeros(4);
  Adam adam(4);
  EXPECT_THROW(adam.Step(Gaussians::Zeros(3), {}, 3, &params), ShapeError);
  EXPECT_THROW(adam.Step(Gaussians::Zeros(4), {}, 4, &params), ShapeError);
  Adam other(5);
  EXPECT_THROW(other.Step(Gaussians::Zeros(4), {}, 3, &params), ShapeError);
  EXPECT_EQ(adam.step, 0);
}

}  // namespace
}  // namespace oraclegs
