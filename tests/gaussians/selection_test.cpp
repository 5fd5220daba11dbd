#include "oraclegs/gaussians/selection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "render/scenes.h"
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
  const GaussianMarks picked = Picked(GaussianMarks{{0.f, 0.25f, 0.5f}, {}}, {2, 0});
  EXPECT_EQ(picked.support, (std::vector<float>{0.5f, 0.f}));
  EXPECT_TRUE(picked.uncertainty.empty());
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

TEST(WithoutFarDust, LeavesOutWhatIsFarTransparentAndSmall) {
  Gaussians model = oraclegs::RandomGaussians(2000, 0.1, 3);
  EXPECT_EQ(WithoutFarDust(model).size(), 2000u) << "a model without any";
  for (const int64_t row : {5, 6, 7, 8}) {
    model.means[3 * row] = 500;
    model.opacity_logits[row] = -4;
    for (int axis = 0; axis < 3; ++axis) model.log_scales[3 * row + axis] = std::log(0.1f);
  }
  model.opacity_logits[6] = 0;                // a lamp far away
  model.log_scales[3 * 7] = std::log(100.f);  // haze
  model.means[3 * 8] = 0;                     // dust, but near
  const std::vector<int64_t> kept = WithoutFarDust(model);
  ASSERT_EQ(kept.size(), 1999u);
  EXPECT_EQ(kept[4], 4);
  EXPECT_EQ(kept[5], 6);
}

TEST(WithoutFarDust, KeepsSmallModels) {
  Gaussians model = oraclegs::RandomGaussians(10, 0.1, 3);
  model.means[0] = 500;
  model.opacity_logits[0] = -4;
  EXPECT_EQ(WithoutFarDust(model).size(), 10u);
}

}  // namespace
}  // namespace oraclegs
