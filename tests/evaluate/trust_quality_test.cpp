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
  for (size_t i = 0; i < view.rgb.data.size(); ++i) view.rgb.data[i] = (i / 3 / 32 + i / 3) % 2 == 0 ? 1.f : 0.f;
  const SupportQuality q = *MeasureTrust(g, {{0.9f}}, {view}, {}).support;
  EXPECT_GT(q.pixels, 50);
  EXPECT_LT(q.pixels, 32 * 32);  // not where nothing is drawn
  EXPECT_GT(q.classes[0].share, 0.02);
  EXPECT_GT(q.classes[0].mean_error, 0.2);  // no map of colors makes the ball a checkerboard
  EXPECT_FALSE(MeasureTrust(g, {{0.9f}}, {view}, {}).of_gaussians);
  EXPECT_FALSE(MeasureTrust(g, {}, {view}, {}).support);
  EXPECT_THROW(MeasureTrust(g, {{0.9f, 0.9f}}, {view}, {}), ShapeError);
  view.mask.assign(32 * 32, 0);
  EXPECT_EQ(MeasureTrust(g, {{0.9f}}, {view}, {}).support->pixels, 0);
}

TEST(MeasureTrust, ComparesUncertaintyWithErrors) {
  // Gray balls before a truth in which the last one is black: the model errs there.
  constexpr int kBalls = 15;
  Gaussians g = Gaussians::Zeros(kBalls);
  for (int64_t i = 0; i < kBalls; ++i) {
    g.means[3 * i] = 0.3f * static_cast<float>(i % 5 - 2), g.means[3 * i + 1] = 0.4f * static_cast<float>(i / 5 - 1);
    g.means[3 * i + 2] = 3;
    g.quats[4 * i] = 1;
    std::fill_n(g.log_scales.data() + 3 * i, 3, std::log(0.08f));
    g.opacity_logits[i] = 6;
  }
  LoadedView view;
  view.camera.width = view.camera.height = 32;
  view.camera.fx = view.camera.fy = 40;
  view.camera.cx = view.camera.cy = 16;
  const Buffer<float> render = MakeRasterizer(kCpu)->Forward(g, view.camera, {}, RenderPass::kInference).image.Clone();
  view.rgb = {32, 32, 3, std::vector<float>(render.span().begin(), render.span().end())};
  for (size_t p = 0; p < 32 * 32; ++p) {
    if (p % 32 >= 22 && p / 32 >= 19) std::fill_n(view.rgb.data.begin() + static_cast<std::ptrdiff_t>(3 * p), 3, 0.f);
  }
  std::vector<float> knows(kBalls, 0.01f), errs(kBalls, 0.3f);
  knows.back() = 0.3f, errs.back() = 0.01f;
  const UncertaintyQuality right_one = *MeasureTrust(g, {{}, knows}, {view}, {}).of_gaussians;

  const OracleQuality& right = right_one.pixels;
  const OracleQuality wrong = MeasureTrust(g, {{}, errs}, {view}, {}).of_gaussians->pixels;
  EXPECT_GT(right.auroc_large_error, 0.9);
  EXPECT_LT(wrong.auroc_large_error, 0.1);
  EXPECT_LT(right.ause_ratio, 0.7);
  EXPECT_GT(right_one.pooled.mae, 0);
  EXPECT_LT(right_one.pooled.mae, 0.3);
  EXPECT_EQ(right_one.pooled.rmse, right_one.means.rmse);  // of one image
  EXPECT_EQ(ToJson(right_one)["published_ause"]["images"]["dssim"], right_one.means.dssim);
  // Models that differ in that ball know it, too.
  Gaussians other = g;
  other.sh = g.sh.Clone();
  for (int64_t c = 0; c < 3; ++c) other.sh[kShFloats * (kBalls - 1) + c] = 0.5f;
  Uncertainty models(g, {other}, {});
  const TrustQuality of_both = MeasureTrust(g, {}, {view}, {}, &models);
  EXPECT_GT(of_both.of_models->pixels.auroc_large_error, 0.9);
  ASSERT_EQ(of_both.errors_of_models.size(), 1);
  EXPECT_EQ(of_both.errors_of_models[0].error.size(), of_both.of_models->pixels.pixels);
  // A model alone expects errors by itself, at the same pixels.
  const std::vector<ExpectedErrors> alone = ErrorsAtUnseen(g, {view}, {});
  ASSERT_EQ(alone.size(), 1);
  EXPECT_EQ(alone[0].error, of_both.errors_of_models[0].error);
  EXPECT_NE(alone[0].expected, of_both.errors_of_models[0].expected);
  // Another exposure is no error: a map of colors explains it.
  for (size_t i = 0; i < view.rgb.data.size(); ++i) view.rgb.data[i] = 0.5f * render[static_cast<int64_t>(i)];
  EXPECT_TRUE(std::isnan(MeasureTrust(g, {{}, errs}, {view}, {}).of_gaussians->pixels.auroc_large_error));
}

}  // namespace
}  // namespace oraclegs
