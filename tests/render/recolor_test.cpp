#include "oraclegs/render/recolor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "oraclegs/render/render.h"
#include "render/scenes.h"

namespace oraclegs {
namespace {

TEST(Recolored, RendersAlphaTimesTheColor) {
  const Gaussians gaussians = RandomGaussians(200, 0.2, 3);
  Buffer<float> colors = Buffer<float>::Empty({200, 3});
  for (int64_t i = 0; i < 200; ++i) {
    for (int64_t c = 0; c < 3; ++c) colors[3 * i + c] = 0.2f + 0.3f * static_cast<float>(c);
  }
  const Gaussians recolored = Recolored(gaussians, colors);
  RenderOptions options;
  options.sh_degree = 0;
  const auto rasterizer = MakeRasterizer(kCpu);
  const RenderOutput out = rasterizer->Forward(recolored, FrontCamera(48, 36), options, RenderPass::kInference);
  EXPECT_GT(MaxAbs(out.alpha), 0.5f);
  for (int64_t i = 0; i < out.image.count(); ++i) {
    EXPECT_NEAR(out.image[i], out.alpha[i / 3] * (0.2f + 0.3f * static_cast<float>(i % 3)), 1e-5f);
  }
}

TEST(Recolored, SharesAllButTheColor) {
  const Gaussians gaussians = RandomGaussians(5, 0.2, 3);
  const Buffer<float> before = gaussians.sh.Clone();
  const Gaussians recolored = Recolored(gaussians, Buffer<float>::Zeros({5, 3}));
  EXPECT_EQ(recolored.means.data(), gaussians.means.data());
  EXPECT_NE(recolored.sh.data(), gaussians.sh.data());
  EXPECT_TRUE(Equal(gaussians.sh, before));
}

TEST(Recolored, RefusesAnotherNumberOfColors) {
  EXPECT_THROW(Recolored(RandomGaussians(5, 0.2, 3), Buffer<float>::Zeros({4, 3})), ShapeError);
}

TEST(SupportClassOf, BelongsToItsLowerBound) {
  EXPECT_EQ(SupportClassOf(1), SupportClass::kSeenByTwo);
  EXPECT_EQ(SupportClassOf(0.75f), SupportClass::kSeenByTwo);
  EXPECT_EQ(SupportClassOf(0.7499f), SupportClass::kSeenByOne);
  EXPECT_EQ(SupportClassOf(0.5f), SupportClass::kSeenByOne);
  EXPECT_EQ(SupportClassOf(0.25f), SupportClass::kTrustedProposal);
  EXPECT_EQ(SupportClassOf(0.2499f), SupportClass::kWeak);
  EXPECT_EQ(SupportClassOf(0), SupportClass::kWeak);
  EXPECT_EQ(SupportClassOf(NAN), SupportClass::kWeak);
}

TEST(SupportColors, AreThoseOfTheClasses) {
  const std::vector<float> support = {0.1f, 0.9f};
  const Buffer<float> colors = SupportColors(support);
  ASSERT_EQ(colors.shape(), Shape({2, 3}));
  const auto weak = ColorOf(SupportClass::kWeak), seen = ColorOf(SupportClass::kSeenByTwo);
  for (size_t c = 0; c < 3; ++c) {
    EXPECT_FLOAT_EQ(colors[static_cast<int64_t>(c)], static_cast<float>(weak[c]) / 255);
    EXPECT_FLOAT_EQ(colors[static_cast<int64_t>(3 + c)], static_cast<float>(seen[c]) / 255);
  }
  EXPECT_NE(std::string(NameOf(SupportClass::kWeak)), NameOf(SupportClass::kSeenByOne));
}

}  // namespace
}  // namespace oraclegs
