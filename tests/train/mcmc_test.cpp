#include "oraclegs/train/mcmc.h"
#include "train/small_scene.h"

#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "support/buffers.h"
#include "support/golden.h"
#include "train/gaussian_fixtures.h"

namespace oraclegs {
namespace {

double Sigmoid(double x) { return 1 / (1 + std::exp(-x)); }
float Logit(double p) { return static_cast<float>(std::log(p / (1 - p))); }

Adam RandomMoments(int64_t n) {
  Adam adam(n);
  adam.m = RandomGaussians(n, 91);
  adam.v = RandomGaussians(n, 92);
  adam.step = 600;
  return adam;
}

/// Row i of every tensor, one after the other.
Buffer<float> Row(const Gaussians& g, int64_t i) {
  std::vector<float> all;
  for (const Buffer<float>& t : Tensors(g)) {
    const std::span<float> row = t.Rows(i, i + 1).span();
    all.insert(all.end(), row.begin(), row.end());
  }
  return Buffer<float>::From({static_cast<int64_t>(all.size())}, all);
}

bool IsCopy(const Gaussians& a, int64_t i, const Gaussians& b, int64_t j) {
  const auto same = [&](const Buffer<float>& x, const Buffer<float>& y) {
    return Equal(x.Rows(i, i + 1), y.Rows(j, j + 1));
  };
  return same(a.means, b.means) && same(a.quats, b.quats) && same(a.sh, b.sh);
}

TEST(RelocateTest, MatchesGolden) {
  const SafetensorsFile golden = OpenGolden("mcmc_relocation");
  const auto opacities = golden.Values<double>("opacities");
  const auto counts = golden.Values<int64_t>("counts");
  const auto scales = golden.Values<double>("scales");
  const auto new_opacities = golden.Values<double>("new_opacities");
  const auto clamped = golden.Values<double>("new_opacities_clamped");
  const auto logits = golden.Values<double>("new_opacity_logits");
  const auto new_scales = golden.Values<double>("new_scales");
  ASSERT_FALSE(opacities.empty());
  for (size_t i = 0; i < opacities.size(); ++i) {
    const Relocated r = Relocate(opacities[i], static_cast<int>(counts[i]));
    EXPECT_NEAR(r.opacity_unclamped, new_opacities[i], 1e-5 * new_opacities[i]) << i;
    EXPECT_NEAR(r.opacity, clamped[i], 1e-5 * clamped[i]) << i;
    EXPECT_NEAR(std::log(r.opacity / (1 - r.opacity)), logits[i], 1e-4) << i;
    for (size_t axis = 0; axis < 3; ++axis) {
      const double wanted = new_scales[3 * i + axis];
      EXPECT_NEAR(r.scale_ratio * scales[3 * i + axis], wanted, 1e-5 * wanted) << i;
    }
  }
}

TEST(RelocateTest, AloneKeepsEverything) {
  const Relocated r = Relocate(0.37, 1);
  EXPECT_DOUBLE_EQ(r.opacity, 0.37);
  EXPECT_DOUBLE_EQ(r.scale_ratio, 1);
}

TEST(RelocateTest, SharesComposeToTheOldOpacity) {
  for (const int n : {2, 3, 10, 51}) {
    const Relocated r = Relocate(0.9, n);
    EXPECT_NEAR(std::pow(1 - r.opacity_unclamped, n), 0.1, 1e-12);
    EXPECT_LT(r.scale_ratio, 1);
  }
}

TEST(RelocateTest, EdgesStayFinite) {
  EXPECT_DOUBLE_EQ(Relocate(0.5, 51).scale_ratio, Relocate(0.5, 500).scale_ratio);
  for (const double o : {0.0, 1e-300, 1e-30, 0.005, 1 - 1e-16, 1.0}) {
    for (const int n : {-1, 1, 2, 51}) {
      const Relocated r = Relocate(o, n);
      EXPECT_TRUE(std::isfinite(r.scale_ratio) && r.scale_ratio > 0) << o << " " << n;
      EXPECT_GE(r.opacity, 0.005);
      EXPECT_LT(r.opacity, 1);
    }
  }
}

TEST(RelocateDeadTest, CompactMomentsOfSourcesBecomeZeroAndNewOnesBeginThere) {
  constexpr int64_t kCount = 100;
  Gaussians full = RandomGaussians(kCount, 5);
  for (int64_t i = 0; i < kCount; i += 7) full.opacity_logits[i] = Logit(0.001);
  Gaussians compact = full.Clone();
  Adam full_adam = RandomMoments(kCount), compact_adam(kCount, ShMoments::kCompact);
  std::iota(compact_adam.sh_v.span().begin(), compact_adam.sh_v.span().end(), 1.f);
  std::fill_n(compact_adam.sh_m.data(), compact_adam.sh_m.count(), uint16_t{7});
  const auto expect_zeros_where_full_has_them = [&] {
    for (int64_t i = 0; i < full.size(); ++i) {
      const bool zero = MaxAbs(full_adam.v.sh.Rows(i, i + 1)) == 0;
      EXPECT_EQ(compact_adam.sh_v[i], zero ? 0 : static_cast<float>(i + 1)) << i;
      for (int k = 0; k < kShFloats; ++k) ASSERT_EQ(compact_adam.sh_m[kShFloats * i + k], zero ? 0 : 7) << i;
    }
  };
  ASSERT_GT(RelocateDead(3, 600, &full, &full_adam), 0);
  RelocateDead(3, 600, &compact, &compact_adam);
  EXPECT_TRUE(SameBits(full, compact));
  expect_zeros_where_full_has_them();
  ASSERT_EQ(AddGaussians(3, 700, 1000, &full, &full_adam), kCount / 20);
  AddGaussians(3, 700, 1000, &compact, &compact_adam);
  EXPECT_TRUE(SameBits(full, compact));
  EXPECT_EQ(compact_adam.sh_m.size(0), kCount + kCount / 20);
  expect_zeros_where_full_has_them();
}

TEST(RelocateDeadTest, HalfMomentsOfSourcesBecomeZero) {
  constexpr int64_t kCount = 100;
  Gaussians full = RandomGaussians(kCount, 5);
  for (int64_t i = 0; i < kCount; i += 7) full.opacity_logits[i] = Logit(0.001);
  Gaussians half = full.Clone();
  Adam full_adam = RandomMoments(kCount), half_adam(kCount, ShMoments::kHalf);
  for (Buffer<uint16_t>* moment : {&half_adam.sh_m, &half_adam.sh_v_half}) {
    std::fill_n(moment->data(), moment->count(), uint16_t{7});
  }
  ASSERT_GT(RelocateDead(3, 600, &full, &full_adam), 0);
  RelocateDead(3, 600, &half, &half_adam);
  EXPECT_TRUE(SameBits(full, half));
  for (int64_t k = 0; k < half_adam.sh_m.count(); ++k) {
    const int wanted = full_adam.v.sh[k] == 0 ? 0 : 7;
    ASSERT_EQ(half_adam.sh_m[k], wanted) << k;
    ASSERT_EQ(half_adam.sh_v_half[k], wanted) << k;
  }
}

TEST(RelocateDeadTest, DeadBecomeCopiesOfSources) {
  constexpr int64_t kCount = 400;
  const Gaussians before = RandomGaussians(kCount, 5);
  for (int64_t i = 0; i < kCount; i += 7) before.opacity_logits[i] = Logit(0.001);
  Gaussians after = before.Clone();
  Adam adam = RandomMoments(kCount);
  const Gaussians m_before = adam.m.Clone(), v_before = adam.v.Clone();
  const Eigen::ArrayXd opacity = 1 / (1 + (-Wide(before.opacity_logits)).exp());
  const Eigen::Array<bool, Eigen::Dynamic, 1> dead = opacity <= 0.005;
  EXPECT_EQ(RelocateDead(3, 600, &after, &adam), dead.count());
  EXPECT_EQ(adam.step, 600);

  std::vector<int> draws(kCount, 0);
  for (int64_t i = 0; i < kCount; ++i) {
    if (!dead[i]) continue;
    int64_t source = -1;
    for (int64_t j = 0; j < kCount && source < 0; ++j) {
      if (IsCopy(after, i, before, j)) source = j;
    }
    ASSERT_GE(source, 0);
    EXPECT_FALSE(dead[source]);
    EXPECT_TRUE(Equal(Row(after, i), Row(after, source)));  // opacity and scale as well
    ++draws[source];
    EXPECT_TRUE(Equal(Row(adam.m, i), Row(m_before, i)));  // the relocated keep their moments
    EXPECT_TRUE(Equal(Row(adam.v, i), Row(v_before, i)));
  }
  for (int64_t j = 0; j < kCount; ++j) {
    if (dead[j]) continue;
    EXPECT_TRUE(IsCopy(after, j, before, j));
    if (draws[j] == 0) {
      EXPECT_TRUE(Equal(Row(after, j), Row(before, j)));
      EXPECT_TRUE(Equal(Row(adam.m, j), Row(m_before, j)));
      continue;
    }
    const Relocated r = Relocate(opacity[j], 1 + draws[j]);
    EXPECT_NEAR(Sigmoid(after.opacity_logits[j]), r.opacity, 1e-6);
    for (int64_t k = 3 * j; k < 3 * j + 3; ++k) {
      EXPECT_NEAR(std::exp(after.log_scales[k] - before.log_scales[k]), r.scale_ratio, 1e-5);
    }
    EXPECT_EQ(MaxAbs(Row(adam.m, j)), 0);
    EXPECT_EQ(MaxAbs(Row(adam.v, j)), 0);
  }
}

TEST(RelocateDeadTest, NothingHappensWhenAllLiveOrAllAreDead) {
  for (const double opacity : {0.5, 0.001}) {
    Gaussians g = RandomGaussians(50, 5);
    Flat(g.opacity_logits).setConstant(Logit(opacity));
    const Gaussians before = g.Clone();
    Adam adam = RandomMoments(50);
    EXPECT_EQ(RelocateDead(3, 600, &g, &adam), 0);
    EXPECT_TRUE(SameBits(g, before));
  }
}

TEST(RelocateDeadTest, NotANumberIsNeverASource) {
  Gaussians g = RandomGaussians(20, 5);
  Flat(g.opacity_logits).setConstant(Logit(0.001));
  g.opacity_logits[3] = Logit(0.4);
  g.opacity_logits[7] = std::nanf("");
  const Gaussians before = g.Clone();
  Adam adam = RandomMoments(20);
  EXPECT_EQ(RelocateDead(3, 600, &g, &adam), 19);
  for (int64_t i = 0; i < 20; ++i) EXPECT_TRUE(IsCopy(g, i, before, 3));
}

TEST(RelocateDeadTest, SourcesAreDrawnByOpacity) {
  constexpr int64_t kCount = 40003;
  Gaussians g = RandomGaussians(kCount, 5);
  Flat(g.opacity_logits).setConstant(Logit(0.001));
  g.opacity_logits[0] = Logit(0.2);
  g.opacity_logits[1] = Logit(0.6);
  g.opacity_logits[2] = Logit(0.8);
  const Gaussians before = g.Clone();
  Adam adam(kCount);
  EXPECT_EQ(RelocateDead(3, 600, &g, &adam), kCount - 3);
  const double draws = kCount - 3;
  const double wanted[3] = {0.125, 0.375, 0.5};
  for (int64_t j = 0; j < 3; ++j) {
    int64_t copies = -1;
    for (int64_t i = 0; i < kCount; ++i) copies += Equal(g.means.Rows(i, i + 1), before.means.Rows(j, j + 1));
    EXPECT_NEAR(static_cast<double>(copies) / draws, wanted[j], 5 * std::sqrt(0.25 / draws));
  }
}

TEST(AddGaussiansTest, AppendsCopiesWithZeroMoments) {
  constexpr int64_t kCount = 230;
  const Gaussians before = RandomGaussians(kCount, 5);
  Gaussians after = before.Clone();
  Adam adam = RandomMoments(kCount);
  const Gaussians m_before = adam.m.Clone();
  const Eigen::ArrayXd opacity = 1 / (1 + (-Wide(before.opacity_logits)).exp());
  EXPECT_EQ(AddGaussians(3, 600, 100000, &after, &adam), 11);  // floor(1.05 * 230) = 241
  ASSERT_EQ(after.size(), kCount + 11);
  after.Check("after");
  adam.m.Check("m");
  ASSERT_EQ(adam.m.size(), kCount + 11);
  ASSERT_EQ(adam.v.size(), kCount + 11);
  std::vector<int> draws(kCount, 0);
  for (int64_t i = kCount; i < after.size(); ++i) {
    int64_t source = -1;
    for (int64_t j = 0; j < kCount && source < 0; ++j) {
      if (IsCopy(after, i, before, j)) source = j;
    }
    ASSERT_GE(source, 0);
    ++draws[source];
    EXPECT_TRUE(Equal(Row(after, i), Row(after, source)));
    EXPECT_EQ(MaxAbs(Row(adam.m, i)), 0);
    EXPECT_EQ(MaxAbs(Row(adam.v, i)), 0);
  }
  for (int64_t j = 0; j < kCount; ++j) {
    EXPECT_TRUE(Equal(Row(adam.m, j), draws[j] ? Buffer<float>::Zeros({59}) : Row(m_before, j)));
    if (draws[j] == 0) {
      EXPECT_TRUE(Equal(Row(after, j), Row(before, j)));
      continue;
    }
    const Relocated r = Relocate(opacity[j], 1 + draws[j]);
    EXPECT_NEAR(Sigmoid(after.opacity_logits[j]), r.opacity, 1e-6);
  }
}

TEST(AddGaussiansTest, GrowsByFivePercentToTheCap) {
  Gaussians g = RandomGaussians(100, 5);
  Adam adam(100);
  std::vector<int64_t> sizes;
  for (int i = 1; i <= 5; ++i) {
    AddGaussians(3, 100 * i, 117, &g, &adam);
    sizes.push_back(g.size());
  }
  EXPECT_THAT(sizes, testing::ElementsAre(105, 110, 115, 117, 117));
  EXPECT_EQ(AddGaussians(3, 700, 50, &g, &adam), 0);  // more than the cap to begin with: none is lost
  EXPECT_EQ(g.size(), 117);
}

TEST(AddGaussiansTest, NoOpacityNoGrowth) {
  Gaussians g = RandomGaussians(100, 5);
  Flat(g.opacity_logits).setConstant(std::nanf(""));
  Adam adam(100);
  EXPECT_EQ(AddGaussians(3, 600, 1000, &g, &adam), 0);
  EXPECT_EQ(g.size(), 100);
}

TEST(McmcTest, SameBitsForAnyNumberOfThreadsAndOtherBitsForAnotherIteration) {
  const auto run = [](int threads, int64_t iteration) {
    const Threads scope(threads);
    Gaussians g = RandomGaussians(20000, 5);
    Flat(g.opacity_logits).segment(100, 9000).setConstant(-9);
    Adam adam(g.size());
    RelocateDead(3, iteration, &g, &adam);
    AddGaussians(3, iteration, 100000, &g, &adam);
    return g;
  };
  const Gaussians one = run(1, 600);
  EXPECT_TRUE(SameBits(one, run(2, 600)));
  EXPECT_TRUE(SameBits(one, run(5, 600)));
  EXPECT_FALSE(SameBits(one, run(1, 700)));
}

TEST(McmcTest, RefusesMomentsOfAnotherSize) {
  Gaussians g = RandomGaussians(10, 5);
  Adam adam(9);
  EXPECT_THROW(RelocateDead(3, 600, &g, &adam), ShapeError);
  EXPECT_THROW(AddGaussians(3, 600, 100, &g, &adam), ShapeError);
}

/// Gaussians after one refinement of a start with dead Gaussians.
Gaussians Refined(const TrainOptions& options, bool* adds_noise) {
  const LossPlan plan(options, Photos(2));
  auto rasterizer = MakeRasterizer(kCpu);
  const std::unique_ptr<Densifier> densifier = MakeMcmcDensifier({options, plan, rasterizer.get()});
  TrainedModel model{Start(), Adam(Start().size())};
  densifier->Begin(model.gaussians.size());
  *adds_noise = densifier->AddsNoise();
  Iteration iteration;
  iteration.seed = kSeed, iteration.number = 40, iteration.refines = true;
  densifier->Refine(iteration, &model);
  return model.gaussians;
}

TEST(McmcDensifier, MovesTheDeadAndGrows) {
  bool adds_noise = false;
  const Gaussians refined = Refined(Options(), &adds_noise);
  EXPECT_TRUE(adds_noise);
  EXPECT_EQ(refined.size(), 63) << "5 % more";
  EXPECT_GT(Flat(refined.opacity_logits).minCoeff(), -6);
}

}  // namespace

}  // namespace oraclegs
