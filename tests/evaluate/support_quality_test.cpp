#include "oraclegs/evaluate/support_quality.h"

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
  EXPECT_DOUBLE_EQ(q.auroc, 1);
  const nlohmann::json json = ToJson(q);
  EXPECT_EQ(json["classes"][0]["name"], "seen by two or more images");
  EXPECT_TRUE(json["classes"][2]["mean_error"].is_null());
  EXPECT_THROW(SupportQuality::FromPixels({0.1f}, {}), ShapeError);
}

TEST(SupportQuality, MeasuresWhatIsDrawn) {
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
  const SupportQuality q = MeasureSupport(g, {0.9f}, {view}, {});
  EXPECT_GT(q.pixels, 50);
  EXPECT_LT(q.pixels, 32 * 32);  // not where nothing is drawn
  EXPECT_GT(q.classes[0].share, 0.02);
  EXPECT_GT(q.classes[0].mean_error, q.classes[3].mean_error);  // the truth is black, the middle of the ball is gray
  view.mask.assign(32 * 32, 0);
  EXPECT_EQ(MeasureSupport(g, {0.9f}, {view}, {}).pixels, 0);
}

}  // namespace
}  // namespace oraclegs
