#include "oraclegs/baselines/random_background.h"

#include <gtest/gtest.h>

#include "baselines/baseline_trainer.h"
#include "support/buffers.h"

namespace oraclegs {
namespace {

TEST(RandomBackground, IsUniformAndAnotherInEachIteration) {
  std::array<double, 3> sum{}, squares{};
  constexpr int kDraws = 3000;
  for (int i = 1; i <= kDraws; ++i) {
    const std::array<float, 3> color = RandomBackground(7, i);
    for (size_t c = 0; c < 3; ++c) {
      EXPECT_TRUE(color[c] >= 0 && color[c] < 1);
      sum[c] += static_cast<double>(color[c]) / kDraws;
      squares[c] += static_cast<double>(color[c] * color[c]) / kDraws;
    }
  }
  for (size_t c = 0; c < 3; ++c) {
    EXPECT_NEAR(sum[c], 0.5, 0.02);
    EXPECT_NEAR(squares[c], 1.0 / 3, 0.02);
  }
  EXPECT_EQ(RandomBackground(7, 5), RandomBackground(7, 5));
  EXPECT_NE(RandomBackground(7, 5), RandomBackground(8, 5));
}

/// The mean alpha of a render after training on one gray photo before an equally gray background.
double CoverAfterTraining(bool random, bool has_alpha) {
  TrainOptions options = Options(150);
  options.opacity_reg = options.scale_reg = 0;
  options.alpha_weight = 0;
  std::vector<TrainView> photos = Photos(1);
  std::fill(photos[0].image.span().begin(), photos[0].image.span().end(), 0.5f);
  if (has_alpha) {
    photos[0].alpha = Buffer<float>::Zeros({photos[0].image.size(0), photos[0].image.size(1)});
    std::fill(photos[0].alpha.span().begin(), photos[0].alpha.span().end(), 1.f);
  }
  const Camera camera = photos[0].camera;
  Gaussians start = Start();
  Flat(start.log_scales).setConstant(-1);
  BaselineSetup setup = SmallSetup(options, std::move(photos), start);
  setup.background = {0.5f, 0.5f, 0.5f};
  setup.baseline.random_background = random;
  Trainer trainer = BaselineTrainer(std::move(setup));
  trainer.Run({}, Silent());
  auto rasterizer = MakeRasterizer(kCpu);
  return Wide(rasterizer->Forward(trainer.gaussians(), camera, {}, RenderPass::kInference).alpha).mean();
}

TEST(RandomBackground, MakesAPhotoOpaqueUnlessItHasTransparency) {
  const double fixed = CoverAfterTraining(false, false);
  EXPECT_GT(CoverAfterTraining(true, false), fixed + 0.05);
  EXPECT_EQ(CoverAfterTraining(true, true), CoverAfterTraining(false, true));
}

}  // namespace
}  // namespace oraclegs
