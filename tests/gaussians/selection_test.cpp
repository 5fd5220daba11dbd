#include "oraclegs/gaussians/selection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "support/buffers.h"

namespace oraclegs {
namespace {

/// Gaussians that differ in their opacity logits only.
Gaussians WithLogits(const std::vector<float>& logits) {
  Gaussians g = Gaussians::Zeros(static_cast<int64_t>(logits.size()));
  std::copy(logits.begin(), logits.end(), g.opacity_logits.data());
  return g;
}

TEST(Picked, TakesRowsOfAllBuffers) {
  Gaussians g = Gaussians::Empty(5);
  uint64_t seed = 1;
  g.ForEach([&](const char*, Buffer<float>& part) { part = RandomNormal(part.shape(), seed++); });
  const Gaussians picked = Picked(g, {4, 1});
  ASSERT_EQ(picked.size(), 2);
  EXPECT_EQ(picked.means[0], g.means[12]);
  EXPECT_EQ(picked.quats[0], g.quats[16]);
  EXPECT_EQ(picked.opacity_logits[1], g.opacity_logits[1]);
  EXPECT_EQ(picked.sh[95], g.sh[95]);
}

TEST(Picked, TakesSupportWhereThereIsAny) {
  EXPECT_EQ(Picked({0.f, 0.25f, 0.5f}, {2, 0}), (std::vector<float>{0.5f, 0.f}));
  EXPECT_TRUE(Picked(std::vector<float>(), {2, 0}).empty());
}

TEST(MostPresent, KeepsTheOrderAndTheFirstOfEquals) {
  const Gaussians g = WithLogits({1, 3, 2, 2, 2});
  EXPECT_EQ(MostPresent(g, {4, 3, 1, 0}, 2), (std::vector<int64_t>{4, 1}));
  EXPECT_EQ(MostPresent(g, {0, 2}, 2), (std::vector<int64_t>{0, 2}));
  EXPECT_EQ(MostPresent(g, {0, 2}, 9), (std::vector<int64_t>{0, 2}));
}

TEST(MostPresent, GoesByTheBroadestSide) {
  Gaussians g = WithLogits({0, 0, 0});
  g.log_scales[0] = 3;                                                              // a needle, area e^3
  g.log_scales[3] = g.log_scales[4] = 2;                                            // a disk, area e^4
  std::fill_n(g.log_scales.data() + 6, 3, std::numeric_limits<float>::infinity());  // inf - inf: nothing
  EXPECT_EQ(MostPresent(g, {0, 1, 2}, 1), std::vector<int64_t>{1});
}

}  // namespace
}  // namespace oraclegs
