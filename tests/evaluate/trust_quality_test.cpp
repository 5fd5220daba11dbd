#include "oraclegs/evaluate/trust_quality.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "oraclegs/core/error.h"

namespace oraclegs {
namespace {

TEST(SupportQuality, MeansByClass) {
  const SupportQuality q = SupportQuality::FromPixels({0.01f, 0.03f, 0.05f, 0.2f}, {0.9f, 0.8f, 0.6f, 0.1f});
  EXPECT_EQ(q.pixels, 4);
  EXPECT_DOUBLE_EQ(q.classes[0].share, 0.5);
  EXPECT_NEAR(q.classes[0].mean_error, 0.02, 1e-6);
  EXPECT_NEAR(q.classes[1].mean_error, 0.05, 1e-6);
  EXPECT_TRUE(std::isnan(q.classes[2].mean_error));
  EXPECT_NEAR(q.classes[3].mean_error, 0.2, 1e-6);
  const nlohmann::json json = ToJson(q);
  EXPECT_EQ(json["classes"][0]["name"], "seen by two or more images");
  EXPECT_TRUE(json["classes"][2]["mean_error"].is_null());
  EXPECT_THROW(SupportQuality::FromPixels({0.1f}, {}), ShapeError);
}

TEST(MeasureTrust, MeasuresWhatIsDrawn) {
  Gaussians g = Gaussians::Zeros(1);  // one gray ball before the camera
  g.means[2] = 3;
  g.quats[0] = 1;
  std::fill_n(g.log_scales.data(), 3, std::log(0.3f));
  g.opacity_logits[0] = 4;
  LoadedView view;
  view.camera.width = view.camera.height = 32;
  view.camera.fx = view.camera.fy = 40;
  view.camera.cx = view.camera.cy = 16;
  view.rgb = {32, 32, 3, std::vector<float>(32 * 32 * 3, 0.f)};
  const SupportQuality q = *MeasureTrust(g, {{0.9f}}, {view}, {}).support;
  EXPECT_GT(q.pixels, 50);
  EXPECT_LT(q.pixels, 32 * 32);  // not where nothing is drawn
  EXPECT_GT(q.classes[0].share, 0.02);
  EXPECT_GT(q.classes[0].mean_error, q.classes[3].mean_error);  // the truth is black, the middle of the ball is gray
  EXPECT_FALSE(MeasureTrust(g, {{0.9f}}, {view}, {}).of_gaussians);
  EXPECT_FALSE(MeasureTrust(g, {}, {view}, {}).support);
  EXPECT_THROW(MeasureTrust(g, {{0.9f, 0.9f}}, {view}, {}), ShapeError);
  view.mask.assign(32 * 32, 0);
  EXPECT_EQ(MeasureTrust(g, {{0.9f}}, {view}, {}).support->pixels, 0);
}

TEST(MeasureTrust, ComparesUncertaintyWithErrors) {
  // Two gray balls before a truth in which the right one is black: the model errs there, least at its faint rim.
  Gaussians g = Gaussians::Zeros(2);
  for (int64_t i = 0; i < 2; ++i) {
    g.means[3 * i] = i == 0 ? -0.6f : 0.6f, g.means[3 * i + 2] = 3;
    g.quats[4 * i] = 1;
    std::fill_n(g.log_scales.data() + 3 * i, 3, std::log(0.15f));
    g.opacity_logits[i] = 6;
  }
  LoadedView view;
  view.camera.width = view.camera.height = 32;
  view.camera.fx = view.camera.fy = 40;
  view.camera.cx = view.camera.cy = 16;
  view.rgb = {32, 32, 3, std::vector<float>(32 * 32 * 3, 0.f)};
  const Buffer<float> render = MakeRasterizer(kCpu)->Forward(g, view.camera, {}, RenderPass::kInference).image.Clone();
  for (size_t p = 0; p < 32 * 32; ++p) {
    for (size_t c = 3 * p; c < 3 * p + 3 && p % 32 < 16; ++c) view.rgb.data[c] = render[static_cast<int64_t>(c)];
  }
  const OracleQuality right = *MeasureTrust(g, {{}, {0.01f, 0.3f}}, {view}, {}).of_gaussians;
  const OracleQuality wrong = *MeasureTrust(g, {{}, {0.3f, 0.01f}}, {view}, {}).of_gaussians;
  EXPECT_GT(right.auroc_large_error, 0.8);
  EXPECT_LT(wrong.auroc_large_error, 0.2);
  EXPECT_LT(right.ause_ratio, 0.5);
  // Models that differ in the right ball know it, too.
  Gaussians other = g;
  other.sh = g.sh.Clone();
  for (int64_t c = 0; c < 3; ++c) other.sh[kShFloats + c] = 0.5f;
  Uncertainty models(g, {other}, {});
  EXPECT_GT(MeasureTrust(g, {}, {view}, {}, {{}, &models}).of_models->auroc_large_error, 0.9);
  // Seen through a map that makes the render black, only the left one is wrong.
  const auto black = [](size_t, const Buffer<float>& image) { std::fill_n(image.data(), image.count(), 0.f); };
  EXPECT_GT(MeasureTrust(g, {{}, {0.3f, 0.01f}}, {view}, {}, {black}).of_gaussians->auroc_large_error, 0.7);
}

}  // namespace
}  // namespace oraclegs
