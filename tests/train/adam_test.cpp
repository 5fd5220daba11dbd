#include "oraclegs/train/adam.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <type_traits>

#include "oraclegs/core/bfloat16.h"
#include "oraclegs/render/splat_math-inl.h"
#include "train/gaussian_fixtures.h"

namespace oraclegs {
namespace {

constexpr double kBeta1 = 0.9, kBeta2 = 0.999, kEpsilon = 1e-15;

/// Textbook Adam in double, one array.
struct SlowAdam {
  Eigen::ArrayXd p, m, v;
  explicit SlowAdam(const Buffer<float>& start)
      : p(Wide(start)), m(Eigen::ArrayXd::Zero(p.size())), v(Eigen::ArrayXd::Zero(p.size())) {}
  /// Takes a step; NaN gradients count as zero.
  void Step(const Buffer<float>& grad, const Eigen::ArrayXd& rate, int64_t t) {
    const Eigen::ArrayXd g = Wide(grad).isNaN().select(0, Wide(grad));
    m = kBeta1 * m + (1 - kBeta1) * g;
    v = kBeta2 * v + (1 - kBeta2) * g * g;
    const double t_double = static_cast<double>(t);
    const Eigen::ArrayXd m_hat = m / (1 - std::pow(kBeta1, t_double)), v_hat = v / (1 - std::pow(kBeta2, t_double));
    p = p - rate * m_hat / (v_hat.sqrt() + kEpsilon);
  }
};

/// Gradients of very different size, some exactly zero, with garbage above the active degree.
Gaussians RandomGrads(int64_t n, uint64_t seed, int degree) {
  Gaussians g = RandomGaussians(n, seed);
  g.ForEach([](const char*, Buffer<float>& t) {
    const Eigen::ArrayXf size = Flat(t).abs();
    Flat(t) *= (size * -3 * std::log(10.f)).exp() * (size > 0.1f).cast<float>();
  });
  Table(g.sh).rightCols(kShFloats - 3 * ShCount(degree)).setConstant(std::nanf(""));
  return g;
}

/// Learning rate of every number of n Gaussians, in the order of Tensors.
std::vector<Eigen::ArrayXd> RateOf(const LearningRates& r, int64_t n) {
  Eigen::ArrayXXd sh = Eigen::ArrayXXd::Constant(kShFloats, n, r.sh_rest);
  sh.topRows(3).setConstant(r.sh0);
  const auto all = [](int64_t count, double x) -> Eigen::ArrayXd { return Eigen::ArrayXd::Constant(count, x); };
  return {all(3 * n, r.means), all(3 * n, r.log_scales), all(4 * n, r.quats), all(n, r.opacity_logits), sh.reshaped()};
}

bool AllClose(const Buffer<float>& x, const Eigen::ArrayXd& wanted, double relative, double absolute) {
  return ((Wide(x) - wanted).abs() <= absolute + relative * wanted.abs()).all();
}

class AdamDegreeTest : public testing::TestWithParam<int> {};

TEST_P(AdamDegreeTest, AgreesWithDoublePrecisionOnEveryTarget) {
  const int degree = GetParam();
  LearningRates rates;
  rates.means = 3e-3;
  ForEachTarget([&](int64_t target) {
    for (const int64_t n : {1, 5, 37}) {  // no size is a whole number of vectors
      const auto rate = RateOf(rates, n);
      const Gaussians start = RandomGaussians(n, 1);
      Gaussians params = start.Clone();
      Adam adam(n);
      std::vector<SlowAdam> slow;
      for (const Buffer<float>& t : Tensors(start)) slow.emplace_back(t);
      for (int64_t step = 1; step <= 6; ++step) {
        const Gaussians grads = RandomGrads(n, 100 + step, degree);
        adam.Step(grads, rates, degree, &params);
        const auto g = Tensors(grads);
        for (size_t k = 0; k < g.size(); ++k) slow[k].Step(g[k], rate[k], step);
      }
      const auto p = Tensors(params), m = Tensors(adam.m), v = Tensors(adam.v);
      for (size_t k = 0; k < p.size(); ++k) {
        EXPECT_TRUE(AllClose(p[k], slow[k].p, 1e-6, 1e-6)) << target << " tensor " << k;
        EXPECT_TRUE(AllClose(m[k], slow[k].m, 1e-5, 1e-8)) << target << " tensor " << k;
        EXPECT_TRUE(AllClose(v[k], slow[k].v, 1e-5, 1e-15)) << target << " tensor " << k;
      }
      const int inactive = kShFloats - 3 * ShCount(degree);
      EXPECT_TRUE((Table(params.sh).rightCols(inactive) == Table(start.sh).rightCols(inactive)).all());
    }
  });
}

/// Adam with compact moments in double, of one Gaussian's SH.
struct SlowCompactAdam {
  Eigen::ArrayXd p, m = Eigen::ArrayXd::Zero(kShFloats);
  double v = 0;
  void Step(const Eigen::ArrayXd& g, const Eigen::ArrayXd& rate, int64_t t) {
    v = kBeta2 * v + (1 - kBeta2) * g.head(3).square().mean();
    const Eigen::ArrayXd now = kBeta1 * m + (1 - kBeta1) * g;
    const double t_double = static_cast<double>(t), v_hat = v / (1 - std::pow(kBeta2, t_double));
    p = p - rate * now / (1 - std::pow(kBeta1, t_double)) / (std::sqrt(v_hat) + kEpsilon);
    for (int k = 0; k < kShFloats; ++k) m[k] = FromBfloat16(ToBfloat16(static_cast<float>(now[k])));
  }
};

TEST_P(AdamDegreeTest, CompactMomentsAgreeWithDoublePrecisionOnEveryTarget) {
  const int degree = GetParam();
  LearningRates rates;
  rates.means = 3e-3;
  ForEachTarget([&](int64_t target) {
    constexpr int64_t kCount = 5;
    const Gaussians start = RandomGaussians(kCount, 1);
    Gaussians params = start.Clone(), full = start.Clone();
    Adam adam(kCount, ShMoments::kCompact), full_adam(kCount);
    const Eigen::ArrayXd rate = RateOf(rates, 1)[4];
    std::vector<SlowCompactAdam> slow;
    for (int64_t i = 0; i < kCount; ++i) slow.push_back({Wide(start.sh.Rows(i, i + 1))});
    for (int64_t step = 1; step <= 6; ++step) {
      const Gaussians grads = RandomGrads(kCount, 100 + step, degree);
      adam.Step(grads, rates, degree, &params);
      full_adam.Step(grads, rates, degree, &full);
      for (int64_t i = 0; i < kCount; ++i) {
        const Eigen::ArrayXd g = Wide(grads.sh.Rows(i, i + 1));
        slow[i].Step(g.isNaN().select(0, g), rate, step);
      }
    }
    for (int64_t i = 0; i < kCount; ++i) {
      // The moment may fall to the other side of a rounding, which moves the value by 1/256 of a step.
      EXPECT_TRUE(AllClose(params.sh.Rows(i, i + 1), slow[i].p, 1e-6, 2e-5)) << target << " Gaussian " << i;
      EXPECT_NEAR(adam.sh_v[i], slow[i].v, 1e-5 * slow[i].v) << target;
      for (int k = 0; k < kShFloats; ++k) {
        const double m = slow[i].m[k];
        EXPECT_NEAR(FromBfloat16(adam.sh_m[kShFloats * i + k]), m, 0x1p-7 * std::abs(m))
            << target << ' ' << i << ' ' << k;
      }
    }
    const int inactive = kShFloats - 3 * ShCount(degree);
    EXPECT_TRUE((Table(params.sh).rightCols(inactive) == Table(start.sh).rightCols(inactive)).all());
    EXPECT_TRUE(Equal(params.means, full.means));
    EXPECT_TRUE(Equal(params.opacity_logits, full.opacity_logits));
  });
}

TEST_P(AdamDegreeTest, HalfMomentsStayNearFullOnesOnEveryTarget) {
  const int degree = GetParam();
  ForEachTarget([&](int64_t target) {
    constexpr int64_t kCount = 9;
    const Gaussians start = RandomGaussians(kCount, 1);
    Gaussians params = start.Clone(), full = start.Clone();
    Adam adam(kCount, ShMoments::kHalf), full_adam(kCount);
    for (int64_t step = 1; step <= 6; ++step) {
      const Gaussians grads = RandomGrads(kCount, 100 + step, degree);
      adam.Step(grads, {3e-3}, degree, &params);
      full_adam.Step(grads, {3e-3}, degree, &full);
    }
    // Each step rounds the first moment by 1/512 of itself at most, the second by less than 1/128.
    EXPECT_LE(MaxAbsError(params.sh, full.sh), 6 * 0.02 * LearningRates().sh0) << target;
    const float largest = MaxAbs(full_adam.m.sh);
    for (int64_t k = 0; k < adam.sh_m.count(); ++k) {
      EXPECT_NEAR(FromBfloat16(adam.sh_m[k]), full_adam.m.sh[k], 0x1p-7 * largest) << target << ' ' << k;
      EXPECT_NEAR(FromBfloat16(adam.sh_v_half[k]), full_adam.v.sh[k], 6 * 0x1p-7 * full_adam.v.sh[k])
          << target << ' ' << k;
    }
    const int inactive = kShFloats - 3 * ShCount(degree);
    EXPECT_TRUE((Table(params.sh).rightCols(inactive) == Table(start.sh).rightCols(inactive)).all());
    EXPECT_TRUE(Equal(params.means, full.means));
    EXPECT_TRUE(Equal(params.quats, full.quats));
  });
}

TEST(AdamTest, HalfSecondMomentsAreRightInTheMean) {
  // Rounded to the nearest, a moment would stop where a step changes it by less than half of what bfloat16 can show:
  // at 1/2 of the square that it goes to, or below.
  constexpr int64_t kCount = 100;
  constexpr int kSteps = 1500;
  Gaussians params = RandomGaussians(kCount, 1);
  Gaussians grads = Gaussians::Zeros(kCount);
  Flat(grads.sh).setConstant(0.75f);
  Adam adam(kCount, ShMoments::kHalf);
  for (int step = 0; step < kSteps; ++step) adam.Step(grads, {1e-3}, kMaxShDegree, &params);
  const double expected = 0.75 * 0.75 * (1 - std::pow(kBeta2, kSteps));
  double sum = 0;
  for (const uint16_t v : adam.sh_v_half.span()) {
    EXPECT_NEAR(FromBfloat16(v), expected, 0.3 * expected);
    sum += FromBfloat16(v);
  }
  EXPECT_NEAR(sum / static_cast<double>(adam.sh_v_half.count()), expected, 0.005 * expected);

  Flat(grads.sh).setConstant(0);  // and they decay where nothing else changes
  for (int step = 0; step < kSteps; ++step) adam.Step(grads, {1e-3}, kMaxShDegree, &params);
  sum = 0;
  for (const uint16_t v : adam.sh_v_half.span()) sum += FromBfloat16(v);
  const double decayed = expected * std::pow(kBeta2, kSteps);
  EXPECT_NEAR(sum / static_cast<double>(adam.sh_v_half.count()), decayed, 0.01 * decayed);
}

TEST(AdamTest, TheConstantHarmonicsSquareIsTheMeanOfAll) {
  namespace math = HWY_NAMESPACE;
  for (int degree = 0; degree <= kMaxShDegree; ++degree) {
    const int count = ShCount(degree);
    double basis[kShCoefficients];
    math::ShBasis(degree, math::Vec3<double>{0.48, -0.6, 0.64}, basis);
    const Eigen::Array3d color_gradient(0.3, -2, 0.7);
    double sum = 0;
    for (int k = 0; k < count; ++k) sum += (basis[k] * color_gradient).square().sum();
    const Eigen::Array3d constant = basis[0] * color_gradient;
    EXPECT_NEAR(constant.square().mean(), sum / (3 * count), 1e-6) << degree;
  }
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

void ExpectSameBitsInBlocks(ShMoments sh_moments) {
  constexpr int64_t kCount = 203;
  Gaussians whole = RandomGaussians(kCount, 1), cut = RandomGaussians(kCount, 1);
  Adam adam(kCount, sh_moments), cut_adam(kCount, sh_moments);
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
  EXPECT_TRUE(Equal(adam.v.means, cut_adam.v.means));
  if (sh_moments == ShMoments::kFull) {
    EXPECT_TRUE(Equal(adam.v.sh, cut_adam.v.sh));
  } else {
    EXPECT_TRUE(Equal(adam.sh_m, cut_adam.sh_m));
    EXPECT_TRUE(sh_moments == ShMoments::kHalf ? Equal(adam.sh_v_half, cut_adam.sh_v_half)
                                               : Equal(adam.sh_v, cut_adam.sh_v));
  }
}

TEST(AdamTest, BlocksGiveTheBitsOfTheWhole) {
  ExpectSameBitsInBlocks(ShMoments::kFull);
  ExpectSameBitsInBlocks(ShMoments::kHalf);
  ExpectSameBitsInBlocks(ShMoments::kCompact);
}

TEST(AdamTest, GrowsByRowsOfZeros) {
  for (const ShMoments sh_moments : {ShMoments::kFull, ShMoments::kHalf, ShMoments::kCompact}) {
    Gaussians params = RandomGaussians(5, 1);
    Adam adam(5, sh_moments);
    adam.Step(RandomGaussians(5, 2), {1e-3}, 3, &params);
    Adam grown = adam.Clone();
    grown.GrowTo(8);
    EXPECT_NO_THROW(grown.Check("a test", 8));
    int buffers = 0;
    grown.ForEachMoment([&](const char* moment, const char* name, auto& all) {
      adam.ForEachMoment([&](const char* of, const char* named, auto& before) {
        if (std::string_view(of) != moment || std::string_view(named) != name) return;
        if constexpr (std::is_same_v<decltype(all), decltype(before)>) {
          EXPECT_TRUE(Equal(all.Rows(0, 5), before)) << moment << name;
          ++buffers;
        }
      });
      EXPECT_TRUE(std::ranges::all_of(all.Rows(5, 8).span(), [](auto x) { return x == 0; })) << moment << name;
    });
    EXPECT_EQ(buffers, 10);
  }
}

TEST(AdamTest, RefusesMomentsOfAnotherShape) {
  Gaussians params = RandomGaussians(4, 1);
  Adam adam(4, ShMoments::kCompact);
  adam.sh_v = Buffer<float>::Zeros({3});
  EXPECT_THROW(adam.BeginStep({1e-3}, 2, &params), ShapeError);
  adam = Adam(4, ShMoments::kHalf);
  adam.sh_v_half = Buffer<uint16_t>::Zeros({3, kShCoefficients, 3});
  EXPECT_THROW(adam.BeginStep({1e-3}, 2, &params), ShapeError);
  adam = Adam(4);
  adam.m.sh = {};
  EXPECT_THROW(adam.BeginStep({1e-3}, 2, &params), ShapeError);
}

TEST(AdamTest, FirstStepMovesByTheLearningRate) {
  // m_hat / sqrt(v_hat) is the sign of the gradient in the first step, whatever its size.
  Gaussians params = Gaussians::Zeros(3);
  Gaussians grads = Gaussians::Zeros(3);
  grads.ForEach([](const char*, Buffer<float>& t) { Flat(t).setConstant(-1e-6f); });
  LearningRates rates;
  rates.means = 0.125;
  Adam adam(3);
  adam.Step(grads, rates, 3, &params);
  EXPECT_EQ(adam.step, 1);
  const auto rate = RateOf(rates, 3);
  const auto p = Tensors(params);
  for (size_t k = 0; k < p.size(); ++k) {
    EXPECT_TRUE(AllClose(p[k], rate[k], 1e-5, 0));
  }
}

TEST(AdamTest, MomentsOfTheForgottenEndAtZero) {
  Gaussians params = Gaussians::Zeros(2), grads = Gaussians::Zeros(2);
  Flat(grads.means).setConstant(1e-10f);
  Adam adam(2);
  adam.Step(grads, {}, 3, &params);
  grads.means.SetZero();
  for (int step = 0; step < 1000; ++step) adam.Step(grads, {}, 3, &params);
  EXPECT_EQ(MaxAbs(adam.m.means), 0);
}

TEST(AdamTest, AStepOfOneGroupIsThatOfTheWholeStepAndLeavesTheOthers) {
  constexpr int64_t kCount = 6001;
  LearningRates rates;
  rates.means = 3e-3;
  for (Buffer<float> Gaussians::*group : {&Gaussians::means, &Gaussians::opacity_logits}) {
    const Gaussians start = RandomGaussians(kCount, 1), first = RandomGaussians(kCount, 2);
    Gaussians params = start.Clone(), whole_params = start.Clone();
    Adam adam(kCount), whole(kCount);
    adam.Step(first, rates, 3, &params);
    whole.Step(first, rates, 3, &whole_params);
    const Gaussians before = params.Clone(), m = adam.m.Clone(), v = adam.v.Clone();
    const Gaussians grads = RandomGaussians(kCount, 3);
    whole.Step(grads, rates, 3, &whole_params);
    {
      const Threads scope(3);
      adam.StepGroup(group, grads, group == &Gaussians::means ? rates.means : rates.opacity_logits, &params);
    }
    EXPECT_EQ(adam.step, 1);
    const std::pair<const Gaussians&, const Gaussians&> moved[] = {
        {params, whole_params}, {adam.m, whole.m}, {adam.v, whole.v}};
    const Gaussians* unmoved[] = {&before, &m, &v};
    for (int k = 0; k < 3; ++k) {
      const auto now = Tensors(moved[k].first), then = Tensors(*unmoved[k]);
      const Buffer<float> wanted = moved[k].second.*group, got = moved[k].first.*group;
      EXPECT_TRUE(SameBytes(got, wanted)) << k;
      for (size_t t = 0; t < now.size(); ++t) {
        EXPECT_EQ(SameBytes(now[t], then[t]), now[t].data() != got.data()) << k << " " << t;
      }
    }
  }
}

TEST(AdamTest, RefusesWhatDoesNotFit) {
  Gaussians params = Gaussians::Zeros(4);
  Adam adam(4);
  EXPECT_THROW(adam.Step(Gaussians::Zeros(3), {}, 3, &params), ShapeError);
  EXPECT_THROW(adam.Step(Gaussians::Zeros(4), {}, 4, &params), ShapeError);
  Adam other(5);
  EXPECT_THROW(other.Step(Gaussians::Zeros(4), {}, 3, &params), ShapeError);
  EXPECT_THROW(adam.StepGroup(&Gaussians::means, Gaussians::Zeros(3), 1, &params), ShapeError);
  EXPECT_THROW(other.StepGroup(&Gaussians::means, Gaussians::Zeros(4), 1, &params), ShapeError);
  EXPECT_EQ(adam.step, 0);
}

}  // namespace
}  // namespace oraclegs
