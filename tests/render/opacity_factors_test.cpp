// RenderOptions::opacity_factors against opacities scaled by hand, the reference renderer and finite differences.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "oraclegs/render/render.h"
#include "render/reference_raster.h"
#include "render/scenes.h"
#include "support/buffers.h"
#include "support/finite_difference.h"

namespace oraclegs {
namespace {

constexpr int kWidth = 24, kHeight = 20;

RenderGrads Upstream() { return RandomUpstream(FrontCamera(kWidth, kHeight), 1); }

struct Rendered {
  Buffer<float> image, alpha, inv_depth;
  Gaussians grads;
  RenderStats stats;
};

Rendered Render(const Gaussians& g, const RenderOptions& options) {
  auto rasterizer = MakeRasterizer(kCpu);
  const RenderOutput out = rasterizer->Forward(g, FrontCamera(kWidth, kHeight), options, RenderPass::kTrain);
  Rendered r{out.image.Clone(), out.alpha.Clone(), out.inv_depth.Clone(), Gaussians::Zeros(g.size()), {}};
  rasterizer->Backward(g, Upstream(), &r.grads);
  r.stats = rasterizer->stats();
  return r;
}

RenderOptions Options(bool antialiased, const Buffer<float>& factors) {
  return {{0.1f, 0.5f, 0.9f}, 3, antialiased, factors};
}

class OpacityFactors : public testing::TestWithParam<bool> {
 protected:
  const bool antialiased = GetParam();
};

TEST_P(OpacityFactors, ChangeNoBitWhenOne) {
  const Gaussians g = RandomGaussians(300, 0.1, 11);
  const Rendered without = Render(g, Options(antialiased, {})),
                 with = Render(g, Options(antialiased, Buffer<float>::Full({300}, 1.f)));
  EXPECT_TRUE(Equal(with.image, without.image));
  EXPECT_TRUE(Equal(with.inv_depth, without.inv_depth));
  EXPECT_TRUE(Equal(with.grads.means, without.grads.means));
  EXPECT_TRUE(Equal(with.grads.opacity_logits, without.grads.opacity_logits));
}

TEST_P(OpacityFactors, LowerTheOpacity) {
  const Gaussians g = RandomGaussians(300, 0.1, 11);
  const Buffer<float> factors = RandomUniform({300}, 2);
  Flat(factors) = Flat(factors) * 0.98f + 0.01f;
  const Rendered scaled = Render(g, Options(antialiased, factors));
  Gaussians by_hand = g;
  const Eigen::ArrayXd opacity = 1 / (1 + (-Wide(g.opacity_logits)).exp()), product = opacity * Wide(factors);
  by_hand.opacity_logits = ToBuffer({300}, (product / (1 - product)).log());
  const Rendered expected = Render(by_hand, Options(antialiased, {}));
  EXPECT_LE(MaxAbsError(scaled.image, expected.image), 2e-5);
  EXPECT_LE(MaxAbsError(scaled.alpha, expected.alpha), 2e-5);
  EXPECT_LE(MaxAbsError(scaled.inv_depth, expected.inv_depth), 2e-5);
  EXPECT_EQ(scaled.stats.visible, expected.stats.visible);  // culled by the opacity that is rendered
  EXPECT_EQ(scaled.stats.tile_pairs, expected.stats.tile_pairs);
  EXPECT_LE(RelativeL2(scaled.grads.means, expected.grads.means), 2e-4);
  EXPECT_LE(RelativeL2(scaled.grads.log_scales, expected.grads.log_scales), 2e-4);
  EXPECT_LE(RelativeL2(scaled.grads.sh, expected.grads.sh), 2e-4);
  // d(f o)/d(logit o) = f o (1 - o), by hand it is f o (1 - f o).
  const Eigen::ArrayXd logits = Wide(expected.grads.opacity_logits) * (1 - opacity) / (1 - product);
  EXPECT_LE(RelativeL2(scaled.grads.opacity_logits, logits), 2e-4);
}

TEST_P(OpacityFactors, MatchCentralDifferencesAboveOne) {
  const Gaussians g = RandomGaussians(12, 0.25, 21);
  const RenderOptions options = Options(antialiased, ToBuffer({12}, Eigen::ArrayXf::LinSpaced(12, 0.5f, 4)));
  const Rendered rendered = Render(g, options);
  ReferenceScene scene(g, FrontCamera(kWidth, kHeight), options);
  const RenderGrads up = Upstream();
  const auto loss = [&] { return scene.Loss(up); };
  const ReferenceImage reference = scene.Render();
  double worst = 0;
  for (size_t i = 0; i < reference.image.size(); ++i) {
    worst = std::max(worst, std::abs(rendered.image.data()[i] - reference.image[i]));
  }
  EXPECT_LE(worst, 3e-5);
  ExpectCentralDifferences("means", loss, scene.means, rendered.grads.means);
  ExpectCentralDifferences("log_scales", loss, scene.log_scales, rendered.grads.log_scales);
  ExpectCentralDifferences("opacity_logits", loss, scene.opacity_logits, rendered.grads.opacity_logits);
}

TEST_P(OpacityFactors, RemoveAGaussianWhenZero) {
  const Gaussians g = RandomGaussians(200, 0.1, 12);
  Buffer<float> factors = Buffer<float>::Full({200}, 1.f);
  factors.Rows(50, 150).SetZero();
  const Rendered with = Render(g, Options(antialiased, factors));
  Gaussians rest = g.Clone();
  rest.ForEach([](const char*, Buffer<float>& t) {
    t.Rows(50, 100).CopyFrom(t.Rows(150, 200));
    t = t.Rows(0, 100);
  });
  const Rendered without = Render(rest, Options(antialiased, {}));
  EXPECT_TRUE(Equal(with.image, without.image));
  EXPECT_EQ(with.stats.visible, without.stats.visible);
  with.grads.ForEach([](const char* name, const Buffer<float>& t) { EXPECT_EQ(MaxAbs(t.Rows(50, 150)), 0) << name; });
}

INSTANTIATE_TEST_SUITE_P(Modes, OpacityFactors, testing::Bool(),
                         [](const auto& info) { return info.param ? "antialiased" : "plain"; });

TEST(OpacityFactorsTest, RefuseAnotherCount) {
  const Gaussians g = RandomGaussians(20, 0.1, 12);
  EXPECT_THROW(Render(g, Options(false, Buffer<float>::Full({19}, 1.f))), ShapeError);
  EXPECT_THROW(Render(g, Options(false, Buffer<float>::Full({20, 1}, 1.f))), ShapeError);
}

}  // namespace
}  // namespace oraclegs
