// RenderOptions::opacity_factors against opacities scaled by hand, the slow twin and finite differences.

#include "render/reference_raster.h"
#include "render/scenes.h"
#include "support/golden.h"
#include "support/tensors.h"

namespace oraclegs {
namespace {

constexpr int kWidth = 24, kHeight = 20;

RenderGrads Upstream() {
  torch::manual_seed(1);
  return {torch::randn({kHeight, kWidth, 3}), torch::randn({kHeight, kWidth}), torch::randn({kHeight, kWidth})};
}

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

RenderOptions Options(bool antialiased, const Buffer<float>& factors) { return {{0.1f, 0.5f, 0.9f}, 3, antialiased, factors}; }

class OpacityFactors : public testing::TestWithParam<bool> {
 protected:
  const bool antialiased = GetParam();
};

TEST_P(OpacityFactors, OnesChangeNoBit) {
  const Gaussians g = RandomGaussians(300, 0.1, 11);
  const Rendered without = Render(g, Options(antialiased, {})),
                 with = Render(g, Options(antialiased, Buffer<float>::Full({300}, 1.f)));
  EXPECT_TRUE(torch::equal(with.image, without.image));
  EXPECT_TRUE(torch::equal(with.inv_depth, without.inv_depth));
  EXPECT_TRUE(torch::equal(with.grads.means, without.grads.means));
  EXPECT_TRUE(torch::equal(with.grads.opacity_logits, without.grads.opacity_logits));
}

TEST_P(OpacityFactors, BelowOneAreLowerOpacities) {
  const Gaussians g = RandomGaussians(300, 0.1, 11);
  torch::manual_seed(2);
  const Buffer<float> factors = torch::rand({300}) * 0.98 + 0.01;
  const Rendered scaled = Render(g, Options(antialiased, factors));
  Gaussians by_hand = g;
  const Buffer<float> opacity = torch::sigmoid(g.opacity_logits.to(torch::kDouble));
  const Buffer<float> product = opacity * factors;
  by_hand.opacity_logits = torch::logit(product).to(torch::kFloat);
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
  EXPECT_LE(RelativeL2(scaled.grads.opacity_logits, expected.grads.opacity_logits * (1 - opacity) / (1 - product)),
            2e-4);
}

TEST_P(OpacityFactors, AboveOneMatchCentralDifferences) {
  const Gaussians g = RandomGaussians(12, 0.25, 21);
  const RenderOptions options = Options(antialiased, torch::linspace(0.5, 4, 12));
  const Rendered rendered = Render(g, options);
  ReferenceScene scene(g, FrontCamera(kWidth, kHeight), options);
  const RenderGrads up = Upstream();
  const auto loss = [&] {
    const ReferenceImage out = scene.Render();
    double sum = 0;
    for (size_t i = 0; i < out.image.size(); ++i) sum += up.image.data()[i] * out.image[i];
    for (size_t i = 0; i < out.alpha.size(); ++i) {
      sum += up.alpha.data()[i] * out.alpha[i] + up.inv_depth.data()[i] * out.inv_depth[i];
    }
    return sum;
  };
  const ReferenceImage reference = scene.Render();
  double worst = 0;
  for (size_t i = 0; i < reference.image.size(); ++i) {
    worst = std::max(worst, std::abs(rendered.image.data()[i] - reference.image[i]));
  }
  EXPECT_LE(worst, 3e-5);
  const auto check = [&](const char* name, std::vector<double>& values, const Buffer<float>& grad) {
    const double scale = grad.abs().max().item<double>();
    for (size_t k = 0; k < values.size(); ++k) {
      double best = 1e30;  // of three steps: a pixel that crosses a threshold on the way is a jump, not a slope
      for (const double step : {1e-4, 1e-5, 1e-6}) {
        const double keep = values[k];
        values[k] = keep + step;
        const double above = loss();
        values[k] = keep - step;
        best = std::min(best, std::abs((above - loss()) / (2 * step) - grad.data()[k]));
        values[k] = keep;
      }
      EXPECT_LE(best, 2e-3 * scale) << name << " " << k;
    }
  };
  check("means", scene.means, rendered.grads.means);
  check("log_scales", scene.log_scales, rendered.grads.log_scales);
  check("opacity_logits", scene.opacity_logits, rendered.grads.opacity_logits);
}

TEST_P(OpacityFactors, ZeroLeavesTheGaussianOut) {
  const Gaussians g = RandomGaussians(200, 0.1, 12);
  Buffer<float> factors = Buffer<float>::Full({200}, 1.f);
  factors.narrow(0, 50, 100).SetZero();
  const Rendered with = Render(g, Options(antialiased, factors));
  Gaussians rest = g;
  rest.ForEach([](const char*, Buffer<float>& t) { t = torch::cat({t.narrow(0, 0, 50), t.narrow(0, 150, 50)}); });
  const Rendered without = Render(rest, Options(antialiased, {}));
  EXPECT_TRUE(torch::equal(with.image, without.image));
  EXPECT_EQ(with.stats.visible, without.stats.visible);
  with.grads.ForEach(
      [](const char* name, const Buffer<float>& t) { EXPECT_EQ(t.narrow(0, 50, 100).abs().max().item<float>(), 0) << name; });
}

INSTANTIATE_TEST_SUITE_P(Modes, OpacityFactors, testing::Bool(),
                         [](const auto& info) { return info.param ? "antialiased" : "plain"; });

TEST(OpacityFactorsTest, RefusesAnotherNumberOfThem) {
  const Gaussians g = RandomGaussians(20, 0.1, 12);
  EXPECT_THROW(Render(g, Options(false, Buffer<float>::Full({19}, 1.f))), ShapeError);
  EXPECT_THROW(Render(g, Options(false, torch::ones({20}, torch::kDouble))), ShapeError);
}

}  // namespace
}  // namespace oraclegs
