#include "oraclegs/evaluate/blended_sums.h"

#include <gtest/gtest.h>

#include <cmath>

#include "oraclegs/core/error.h"

namespace oraclegs {
namespace {

Camera SmallCamera() {
  Camera camera;
  camera.width = camera.height = 24;
  camera.fx = camera.fy = 30;
  camera.cx = camera.cy = 12;
  return camera;
}

/// A ball at the middle, and one that hides a part of it.
Gaussians TwoBalls() {
  Gaussians g = Gaussians::Zeros(2);
  for (int64_t i = 0; i < 2; ++i) {
    g.means[3 * i] = 0.2f * static_cast<float>(i), g.means[3 * i + 2] = 3 - static_cast<float>(i);
    g.quats[4 * i] = 1;
    std::fill_n(g.log_scales.data() + 3 * i, 3, std::log(0.2f));
    g.opacity_logits[i] = 0.5f;
  }
  return g;
}

TEST(BlendedSums, AreWeightsTimesNumbers) {
  const Gaussians g = TwoBalls();
  BlendedSums sums(g, {});
  Buffer<float> numbers = Buffer<float>::Full({24, 24, 3}, 1.f);
  for (int64_t p = 0; p < 24 * 24; ++p) numbers[3 * p] = 0.5f, numbers[3 * p + 2] = p % 24 < 12 ? 1.f : 0.f;
  sums.Take(SmallCamera(), numbers);
  const RenderOutput out = MakeRasterizer(kCpu)->Forward(g, SmallCamera(), {}, RenderPass::kInference);
  double alpha = 0, left = 0;
  for (int64_t p = 0; p < 24 * 24; ++p) {
    alpha += static_cast<double>(out.alpha[p]);
    left += p % 24 < 12 ? static_cast<double>(out.alpha[p]) : 0;
  }
  EXPECT_NEAR(sums.Of(0, 1) + sums.Of(1, 1), alpha, 1e-3) << "the weights of all make up alpha";
  EXPECT_NEAR(sums.Of(0, 2) + sums.Of(1, 2), left, 1e-3);
  for (int64_t i = 0; i < 2; ++i) EXPECT_NEAR(sums.Of(i, 0), sums.Of(i, 1) / 2, 1e-4);
  EXPECT_GT(sums.Of(1, 1), sums.Of(0, 1)) << "the nearer one is larger, and hides the other";
}

TEST(BlendedSums, RefusesNumbersOfAnotherSize) {
  BlendedSums sums(TwoBalls(), {});
  EXPECT_THROW(sums.Take(SmallCamera(), Buffer<float>::Zeros({24, 23, 3})), ShapeError);
}

}  // namespace
}  // namespace oraclegs
