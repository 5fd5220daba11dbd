#include "oraclegs/train/view_sampler.h"

#include <gmock/gmock.h>

#include <set>

#include "oraclegs/core/error.h"

namespace oraclegs {
namespace {

TEST(ViewSamplerTest, EveryRoundShowsEachPhotoOnce) {
  ViewSampler sampler(7, 9, 0);
  std::set<std::vector<int>> orders;
  for (int round = 0; round < 20; ++round) {
    std::vector<int> order;
    for (int k = 0; k < 9; ++k) {
      const SampledView view = sampler.Next(0.5);
      EXPECT_EQ(view.kind, ViewKind::kPhoto);
      order.push_back(view.index);
    }
    EXPECT_EQ(std::set<int>(order.begin(), order.end()).size(), 9u);
    orders.insert(order);
  }
  EXPECT_GT(orders.size(), 15u);
}

TEST(ViewSamplerTest, KindsComeWithTheirProbability) {
  ViewSampler sampler(1, 5, 3);
  int proposals = 0;
  std::vector<int> count(3, 0);
  constexpr int kDraws = 20000;
  for (int k = 0; k < kDraws; ++k) {
    const SampledView view = sampler.Next(0.2);
    if (view.kind != ViewKind::kProposal) continue;
    ++proposals;
    ++count.at(view.index);
  }
  EXPECT_NEAR(proposals, 0.2 * kDraws, 5 * std::sqrt(kDraws * 0.2 * 0.8));
  for (const int c : count) EXPECT_NEAR(c, proposals / 3.0, 1);  // a stack empties before it is refilled
}

TEST(ViewSamplerTest, EdgesOfTheProbability) {
  ViewSampler sampler(1, 2, 2);
  for (int k = 0; k < 50; ++k) EXPECT_EQ(sampler.Next(0).kind, ViewKind::kPhoto);
  for (int k = 0; k < 50; ++k) EXPECT_EQ(sampler.Next(1).kind, ViewKind::kProposal);
  ViewSampler only_proposals(1, 0, 2);
  EXPECT_EQ(only_proposals.Next(0).kind, ViewKind::kProposal);
}

TEST(ViewSamplerTest, SeedDecidesTheOrder) {
  ViewSampler a(3, 12, 4), b(3, 12, 4), c(4, 12, 4);
  bool differs = false;
  for (int k = 0; k < 100; ++k) {
    const SampledView x = a.Next(0.3), y = b.Next(0.3), z = c.Next(0.3);
    EXPECT_TRUE(x.kind == y.kind && x.index == y.index);
    differs |= x.kind != z.kind || x.index != z.index;
  }
  EXPECT_TRUE(differs);
}

TEST(ViewSamplerTest, RestoredStateContinuesTheSequence) {
  ViewSampler a(3, 12, 4);
  for (int k = 0; k < 17; ++k) a.Next(0.3);
  ViewSampler b(3, 12, 4);
  b.Restore(a.state());
  for (int k = 0; k < 100; ++k) {
    const SampledView x = a.Next(0.3), y = b.Next(0.3);
    EXPECT_TRUE(x.kind == y.kind && x.index == y.index);
  }
}

TEST(ViewSamplerTest, RefusesStateThatDoesNotFit) {
  ViewSampler sampler(3, 4, 0);
  EXPECT_THROW(sampler.Restore({{4}, {}, 0, 4, 0}), InputError);
  EXPECT_THROW(sampler.Restore({{-1}, {}, 0, 4, 0}), InputError);
  EXPECT_THROW(sampler.Restore({{1, 1}, {}, 0, 4, 0}), InputError);
  EXPECT_THROW(sampler.Restore({{}, {0}, 0, 4, 0}), InputError);
  EXPECT_NO_THROW(sampler.Restore({{3, 0}, {}, 5, 4, 0}));
  try {
    sampler.Restore({{1}, {}, 5, 4, 2});  // the stacks alone would fit
    ADD_FAILURE() << "the state of another number of proposals was accepted";
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("4 photos and 2 proposals, this run has 4 and 0"));
  }
}

TEST(ViewSamplerTest, NeedsAView) { EXPECT_THROW(ViewSampler(1, 0, 0), ShapeError); }

}  // namespace
}  // namespace oraclegs
