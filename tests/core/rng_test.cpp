#include "oraclegs/core/rng.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

namespace oraclegs {
namespace {

using testing::ElementsAre;

// Known answers of the authors' own library (Random123, kat_vectors, philox4x32-10).
TEST(Philox, KnownAnswers) {
  constexpr uint64_t kOnes = ~uint64_t{0};
  EXPECT_THAT(Philox::Draw(0, 0, 0).x, ElementsAre(0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8));
  EXPECT_THAT(Philox::Draw(kOnes, kOnes, kOnes).x, ElementsAre(0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd));
  EXPECT_THAT(Philox::Draw(0x299f31d0a4093822, 0x0370734413198a2e, 0x85a308d3243f6a88).x,
              ElementsAre(0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1));
}

TEST(Rng, ACounterIsAllThereIsToStore) {
  Rng rng(7, RandomStream::kViewOrder);
  for (int i = 0; i < 10; ++i) rng.Uniform();
  EXPECT_EQ(rng.counter(), 10u);
  Rng resumed(7, RandomStream::kViewOrder, rng.counter());
  for (int i = 0; i < 10; ++i) EXPECT_EQ(rng.Uniform(), resumed.Uniform());
}

TEST(Rng, SeedsAndStreamsDiffer) {
  std::set<double> first;
  for (const uint64_t seed : {0, 1, 2}) {
    for (const auto stream : {RandomStream::kNoise, RandomStream::kAdd}) first.insert(Rng(seed, stream).Uniform());
  }
  EXPECT_EQ(first.size(), 6u);
}

TEST(Rng, UniformHasItsMeanAndVariance) {
  constexpr int kDraws = 100'000;
  Rng rng(1, RandomStream::kNoise);
  double sum = 0, squares = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double u = rng.Uniform();
    ASSERT_GE(u, 0);
    ASSERT_LT(u, 1);
    sum += u;
    squares += u * u;
  }
  const double mean = sum / kDraws;
  EXPECT_NEAR(mean, 0.5, 5 * std::sqrt(1.0 / 12 / kDraws));
  EXPECT_NEAR(squares / kDraws - mean * mean, 1.0 / 12, 2e-3);
}

TEST(Rng, IndexStaysInsideAndReachesAll) {
  Rng rng(1, RandomStream::kViewOrder);
  std::set<int64_t> seen;
  for (int i = 0; i < 1000; ++i) seen.insert(rng.Index(7));
  EXPECT_THAT(seen, ElementsAre(0, 1, 2, 3, 4, 5, 6));
  EXPECT_EQ(rng.Index(1), 0);
}

TEST(Rng, RangeIsScaled) {
  Rng rng(1, RandomStream::kViewOrder), unit(1, RandomStream::kViewOrder);
  EXPECT_DOUBLE_EQ(rng.Uniform(-2, 4), -2 + 6 * unit.Uniform());
}

TEST(OpenUniform, NeverReachesItsEnds) {
  EXPECT_GT(OpenUniform(0), 0.f);
  EXPECT_LT(OpenUniform(~uint32_t{0}), 1.f);
}

}  // namespace
}  // namespace oraclegs
