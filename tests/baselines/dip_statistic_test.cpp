#include "oraclegs/baselines/mode_floaters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "oraclegs/core/rng.h"

namespace oraclegs {
namespace {

std::vector<float> Draws(int n, uint64_t seed) {
  Rng rng(seed, RandomStream::kInitialPoints);
  std::vector<float> draws;
  for (int i = 0; i < n; ++i) draws.push_back(static_cast<float>(rng.Uniform()));
  return draws;
}

TEST(DipStatistic, IsLeastForOneMode) {
  EXPECT_EQ(DipStatistic({}), 0);
  EXPECT_EQ(DipStatistic({3}), 0.5);
  EXPECT_EQ(DipStatistic({3, 3, 3, 3}), 0.125);
  EXPECT_EQ(DipStatistic({5, 1, 4, 2, 3}), 0.1);                      // evenly spaced
  EXPECT_EQ(DipStatistic({0, 8, 12, 14, 15, 17, 21, 29}), 1.0 / 16);  // dense in the middle
}

TEST(DipStatistic, IsAQuarterForTwoHeaps) {
  std::vector<float> heaps(1000, 0.f);
  std::fill(heaps.begin() + 500, heaps.end(), 1.f);
  EXPECT_NEAR(DipStatistic(heaps), 0.25, 1e-9);
  // A heap of a quarter of the numbers: the nearest unimodal function misses it by half.
  std::fill(heaps.begin(), heaps.begin() + 750, 0.f);
  EXPECT_NEAR(DipStatistic(heaps), 0.125, 1e-9);
}

/// Expected values: the authors' program, as in the R package diptest.
TEST(DipStatistic, AgreesWithThePublishedAlgorithm) {
  EXPECT_NEAR(DipStatistic({-2, -1, 0, 1, 1, 16, 16, 18, 19, 22, 24}), 0.177865613, 1e-9);
  EXPECT_NEAR(DipStatistic({0.188637f, 0.269881f, 0.441904f, 0.487574f, 0.555528f, 0.581577f, 0.84141f}), 0.097030672,
              1e-6);
  EXPECT_NEAR(DipStatistic({-4, -1, -1, 0, 1, 2, 2, 2, 17}), 0.111111111, 1e-9);
}

TEST(DipStatistic, IgnoresScaleAndOrder) {
  std::vector<float> draws = Draws(200, 1), scaled;
  for (const float x : draws) scaled.push_back(8 * x - 4);
  EXPECT_NEAR(DipStatistic(draws), DipStatistic(scaled), 1e-6);
  std::reverse(draws.begin(), draws.end());
  EXPECT_NEAR(DipStatistic(draws), DipStatistic(scaled), 1e-6);
}

TEST(DipStatistic, ShrinksForLargeSamplesOfOneMode) {
  EXPECT_LT(DipStatistic(Draws(100000, 1)), 0.003);
  std::vector<float> two = Draws(100000, 1);
  for (size_t i = 0; i < two.size(); i += 2) two[i] += 3;
  EXPECT_NEAR(DipStatistic(two), 1.0 / 6, 0.003);  // a gap of twice the width of both heaps: 2 / 3 of a quarter
}

}  // namespace
}  // namespace oraclegs
