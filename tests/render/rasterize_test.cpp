// The rasterizer against a slow reference renderer, closed forms and finite differences.

#include "oraclegs/render/render.h"
#include "render/reference_raster.h"
#include "render/scenes.h"
#include "support/buffers.h"
#include "support/finite_difference.h"

namespace oraclegs {
namespace {

double MaxError(const Buffer<float>& x, const std::vector<double>& ref) {
  const float* v = x.data();
  double worst = 0;
  for (size_t i = 0; i < ref.size(); ++i) worst = std::max(worst, std::abs(v[i] - ref[i]));
  return worst;
}

/// Fraction of values further than `tolerance` from the reference: decisions at a threshold may fall the other way.
double FlippedShare(const Buffer<float>& x, const std::vector<double>& ref, double tolerance) {
  const float* v = x.data();
  int64_t flips = 0;
  for (size_t i = 0; i < ref.size(); ++i) flips += std::abs(v[i] - ref[i]) > tolerance;
  return static_cast<double>(flips) / static_cast<double>(ref.size());
}

struct SceneCase {
  const char* name;
  int64_t gaussians;
  double scale;
  int width, height;
  bool antialiased;
};

class RasterizeReference : public testing::TestWithParam<SceneCase> {};

TEST_P(RasterizeReference, AgreesWithTheReference) {
  const SceneCase& c = GetParam();
  const Gaussians g = RandomGaussians(c.gaussians, c.scale, 11);
  const Camera camera = FrontCamera(c.width, c.height);
  const RenderOptions options{{0.3f, 0.1f, 0.6f}, 3, c.antialiased};
  auto rasterizer = MakeRasterizer(kCpu);
  const RenderOutput out = rasterizer->Forward(g, camera, options, RenderPass::kTrain);
  Gaussians grads = Gaussians::Empty(g.size());
  rasterizer->Backward(g, {Buffer<float>::Full({c.height, c.width, 3}, 1.f), {}, {}}, &grads);
  grads.ForEach([](const char* name, const Buffer<float>& t) { EXPECT_TRUE(AllFinite(t)) << name; });
  const ReferenceImage ref = ReferenceScene(g, camera, options).Render();
  // One contributor at alpha = 1/255 weighs up to 0.4 % of a color; anything larger is a mistake.
  EXPECT_LE(MaxError(out.image, ref.image), 0.02);
  EXPECT_LE(FlippedShare(out.image, ref.image, 3e-5), 0.002);
  EXPECT_LE(FlippedShare(out.alpha, ref.alpha, 3e-5), 0.002);
  EXPECT_LE(FlippedShare(out.inv_depth, ref.inv_depth, 3e-5), 0.002);
}

INSTANTIATE_TEST_SUITE_P(Scenes, RasterizeReference,
                         testing::Values(SceneCase{"small", 400, 0.02, 80, 64, false},
                                         SceneCase{"needles_and_sheets", 300, 0.2, 67, 45, false},
                                         SceneCase{"huge", 60, 3.0, 50, 50, false},
                                         SceneCase{"long_lists", 3000, 0.15, 33, 35, false},
                                         SceneCase{"antialiased", 400, 0.01, 64, 48, true},
                                         SceneCase{"one_pixel", 50, 0.3, 1, 1, false}),
                         [](const auto& info) { return info.param.name; });

TEST(RasterizeClosedForm, RendersOneGaussianByItsFormula) {
  Gaussians g = Gaussians::Zeros(1);
  const double z = 4, scale = 0.3, opacity = 0.8;
  g.means.data()[2] = static_cast<float>(z);
  Flat(g.log_scales).setConstant(static_cast<float>(std::log(scale)));
  g.quats.data()[0] = 2;  // any length is the identity
  g.opacity_logits[0] = static_cast<float>(std::log(opacity / (1 - opacity)));
  Camera camera;
  camera.width = 40, camera.height = 30;
  camera.fx = 50, camera.fy = 60, camera.cx = 19.5, camera.cy = 15.25;
  const RenderOutput out = MakeRasterizer(kCpu)->Forward(g, camera, {{1, 0, 0}, 0, false}, RenderPass::kInference);
  const double var_x = std::pow(50 / z * scale, 2) + 0.3, var_y = std::pow(60 / z * scale, 2) + 0.3;
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 40; ++x) {
      const double dx = x + 0.5 - 19.5, dy = y + 0.5 - 15.25;
      double alpha = opacity * std::exp(-0.5 * (dx * dx / var_x + dy * dy / var_y));
      if (alpha < 1.0 / 255) alpha = 0;
      EXPECT_NEAR(out.alpha.data()[y * 40 + x], alpha, 1e-5);
      EXPECT_NEAR(out.inv_depth.data()[y * 40 + x], alpha / z, 1e-5);
      EXPECT_NEAR(out.image.data()[3 * (y * 40 + x)], 0.5 * alpha + (1 - alpha), 1e-5);
      EXPECT_NEAR(out.image.data()[3 * (y * 40 + x) + 1], 0.5 * alpha, 1e-5);
    }
  }
}

TEST(RasterizeClosedForm, KeepsASingleColor) {
  Gaussians g = RandomGaussians(500, 0.1, 5);
  g.sh.SetZero();
  Table(g.sh).leftCols(3).setConstant((0.7f - 0.5f) / 0.28209479177387814f);
  const RenderOutput out =
      MakeRasterizer(kCpu)->Forward(g, FrontCamera(64, 48), {{0, 0, 0}, 3, false}, RenderPass::kInference);
  for (int64_t i = 0; i < out.image.count(); ++i) EXPECT_NEAR(out.image[i], 0.7f * out.alpha[i / 3], 1e-5) << i;
}

TEST(RasterizeClosedForm, RendersBackgroundWithoutGaussiansInView) {
  Gaussians g = RandomGaussians(20, 0.1, 5);
  Table(g.means).col(2) *= -1;
  auto rasterizer = MakeRasterizer(kCpu);
  const RenderOutput out =
      rasterizer->Forward(g, FrontCamera(20, 20), {{0.2f, 0.4f, 0.6f}, 3, false}, RenderPass::kTrain);
  const float background[] = {0.2f, 0.4f, 0.6f};
  for (int64_t i = 0; i < out.image.count(); ++i) EXPECT_EQ(out.image[i], background[i % 3]) << i;
  EXPECT_EQ(rasterizer->stats().visible, 0);
  Gaussians grads = Gaussians::Zeros(20);
  rasterizer->Backward(g, {Buffer<float>::Full({20, 20, 3}, 1.f), {}, {}}, &grads);
  grads.ForEach([](const char*, const Buffer<float>& t) { EXPECT_EQ(MaxAbs(t), 0); });
}

TEST(RasterizeClosedForm, RendersNoGaussians) {
  const Gaussians none = Gaussians::Zeros(0);
  auto rasterizer = MakeRasterizer(kCpu);
  const RenderOutput out = rasterizer->Forward(none, FrontCamera(17, 9), {{1, 1, 1}, 3, false}, RenderPass::kTrain);
  Gaussians grads = Gaussians::Zeros(0);
  rasterizer->Backward(none, {Buffer<float>::Full({9, 17, 3}, 1.f), {}, {}}, &grads);
  EXPECT_EQ(Flat(out.image).minCoeff(), 1);
  EXPECT_EQ(Flat(out.alpha).maxCoeff(), 0);
}

class RasterizeGradient : public testing::TestWithParam<bool> {};

TEST_P(RasterizeGradient, MatchesCentralDifferences) {
  const Gaussians g = RandomGaussians(12, 0.25, 21);
  const Camera camera = FrontCamera(24, 20);
  const RenderOptions options{{0.1f, 0.5f, 0.9f}, 3, GetParam()};
  const RenderGrads up = RandomUpstream(camera, 1);
  auto rasterizer = MakeRasterizer(kCpu);
  rasterizer->Forward(g, camera, options, RenderPass::kTrain);
  Gaussians grads = Gaussians::Zeros(g.size());
  rasterizer->Backward(g, up, &grads);

  ReferenceScene scene(g, camera, options);
  const auto loss = [&] { return scene.Loss(up); };
  ExpectCentralDifferences("means", loss, scene.means, grads.means);
  ExpectCentralDifferences("log_scales", loss, scene.log_scales, grads.log_scales);
  ExpectCentralDifferences("quats", loss, scene.quats, grads.quats);
  ExpectCentralDifferences("opacity_logits", loss, scene.opacity_logits, grads.opacity_logits);
  ExpectCentralDifferences("sh", loss, scene.sh, grads.sh, 5);
}

INSTANTIATE_TEST_SUITE_P(Modes, RasterizeGradient, testing::Bool(),
                         [](const auto& info) { return info.param ? "antialiased" : "plain"; });

}  // namespace
}  // namespace oraclegs
