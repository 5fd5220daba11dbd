#include "oraclegs/gaussians/far_dust.h"

#include <gtest/gtest.h>

#include <cmath>

#include "render/scenes.h"

namespace oraclegs {
namespace {

TEST(WithoutFarDust, LeavesOutWhatIsFarTransparentAndSmall) {
  Gaussians model = RandomGaussians(2000, 0.1, 3);
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
  Gaussians model = RandomGaussians(10, 0.1, 3);
  model.means[0] = 500;
  model.opacity_logits[0] = -4;
  EXPECT_EQ(WithoutFarDust(model).size(), 10u);
}

}  // namespace
}  // namespace oraclegs
