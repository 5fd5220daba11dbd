#include "oraclegs/evaluate/evaluate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "oraclegs/core/interrupt.h"
#include "oraclegs/evaluate/metrics.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/render/render.h"
#include "support/buffers.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

Camera FrontCamera() {
  Camera camera;
  camera.width = 40, camera.height = 30;
  camera.fx = camera.fy = 35;
  camera.cx = 20, camera.cy = 15;
  return camera;
}

/// One big opaque red Gaussian in front of the camera.
Gaussians RedBlob() {
  const Gaussians g = Gaussians::Zeros(1);
  g.means[2] = 3;
  std::fill_n(g.log_scales.data(), 3, std::log(0.3f));
  g.quats[0] = 1;
  g.opacity_logits[0] = 8;
  g.sh[0] = 1.5f;
  g.sh[1] = g.sh[2] = -1.5f;
  return g;
}

/// Rows [begin, end) of the image.
void FillRows(const Buffer<float>& image, int64_t begin, int64_t end, float value) {
  const Buffer<float> rows = image.Rows(begin, end);
  std::fill_n(rows.data(), rows.count(), value);
}

ImageF ToImageF(const Buffer<float>& t) {
  ImageF image;
  image.height = static_cast<int>(t.size(0)), image.width = static_cast<int>(t.size(1)), image.channels = 3;
  image.data.assign(t.data(), t.data() + t.count());
  return image;
}

const RenderOptions kOnGray{{0.5f, 0.5f, 0.5f}};

Buffer<float> Rendered(const Gaussians& g) {
  return MakeRasterizer(kCpu)->Forward(g, FrontCamera(), kOnGray, RenderPass::kInference).image.Clone();
}

LoadedView ViewOf(const std::string& name, const Buffer<float>& image) {
  LoadedView view;
  view.name = name;
  view.camera = FrontCamera();
  view.rgb = ToImageF(image);
  return view;
}

TEST(Evaluate, ScoresItsOwnRenderAsPerfect) {
  const Gaussians g = RedBlob();
  // The view need not be 8-bit itself: both sides are rounded alike.
  const TestMetrics metrics = Evaluate(g, {ViewOf("a.png", Rendered(g))}, kOnGray, {}, Silent());
  ASSERT_EQ(metrics.views.size(), 1u);
  EXPECT_TRUE(std::isinf(metrics.psnr));
  EXPECT_NEAR(metrics.ssim, 1, 2e-6);
}

TEST(Evaluate, AveragesViewsAndHonorsMasks) {
  const Gaussians g = RedBlob();
  const Buffer<float> image = Quantized(Rendered(g));
  Buffer<float> brighter = image.Clone();
  for (float& value : brighter.span()) value += 0.1f;
  brighter = Quantized(brighter);
  const Buffer<float> spoilt = brighter.Clone();
  FillRows(spoilt, 0, 10, 0);
  LoadedView masked = ViewOf("b.png", spoilt);
  masked.mask.assign(40 * 30, 1);
  std::fill_n(masked.mask.begin(), 40 * 10, uint8_t{0});
  const TestMetrics metrics = Evaluate(g, {ViewOf("a.png", brighter), masked}, kOnGray, {}, Silent());
  ASSERT_EQ(metrics.views.size(), 2u);
  EXPECT_EQ(metrics.views[1].name, "b.png");
  EXPECT_NEAR(metrics.views[0].psnr, Psnr(image, brighter), 1e-9);
  EXPECT_NEAR(metrics.views[1].psnr, metrics.views[0].psnr, 0.5);
  EXPECT_NEAR(metrics.psnr, (metrics.views[0].psnr + metrics.views[1].psnr) / 2, 1e-9);
  EXPECT_NEAR(metrics.ssim, (metrics.views[0].ssim + metrics.views[1].ssim) / 2, 1e-9);
  EXPECT_GT(metrics.psnr_color_corrected, metrics.psnr);
}

TEST(Evaluate, ScoresRendersAsExposed) {
  const Gaussians g = RedBlob();
  Buffer<float> brighter = Rendered(g);
  for (float& value : brighter.span()) value *= 1.25f;
  EvaluateExtras extras;
  extras.expose = [](size_t view, const Buffer<float>& render) {
    EXPECT_EQ(view, 0u);
    for (float& value : render.span()) value *= 1.25f;
  };
  const TestMetrics metrics = Evaluate(g, {ViewOf("a.png", brighter)}, kOnGray, extras, Silent());
  EXPECT_TRUE(std::isinf(metrics.psnr));
  EXPECT_NEAR(metrics.more.at("psnr_mean_exposure"), Psnr(Quantized(Rendered(g)), Quantized(brighter)), 1e-9);
  EXPECT_EQ(metrics.conventions.count("psnr_mean_exposure"), 1u);
}

TEST(Evaluate, WarnsOfAFullyMaskedViewAndDoesNotScoreIt) {
  const Gaussians g = RedBlob();
  LoadedView masked = ViewOf("nothing.png", Rendered(g));
  masked.mask.assign(40 * 30, 0);
  std::vector<std::string> warnings;
  int steps = 0;
  const Listener listener = [&](const Event& event) {
    if (const auto* warning = std::get_if<Warning>(&event)) warnings.push_back(warning->text);
    steps += std::holds_alternative<StepDone>(event) ? 1 : 0;
  };
  const TestMetrics metrics =
      Evaluate(g, {masked, ViewOf("a.png", Buffer<float>::Zeros({30, 40, 3}))}, kOnGray, {}, listener);
  EXPECT_EQ(metrics.views.size(), 1u);
  EXPECT_TRUE(std::isfinite(metrics.psnr));
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("nothing.png"), std::string::npos);
  EXPECT_EQ(steps, 2);
}

/// Score "differing": fraction of the values that differ.
ImageScores Differing() {
  ImageScores scores;
  scores.conventions = {{"differing", "share of the values that differ"}};
  scores.of = [](const Buffer<float>& a, const Buffer<float>& b) {
    double differing = 0;
    for (int64_t i = 0; i < a.count(); ++i) differing += a[i] != b[i] ? 1 : 0;
    return std::map<std::string, double>{{"differing", differing / static_cast<double>(a.count())}};
  };
  return scores;
}

TEST(Evaluate, ShowsFurtherScoresTheTruthWhereMasked) {
  const Gaussians g = RedBlob();
  const Buffer<float> image = Quantized(Rendered(g)), spoilt = image.Clone();
  FillRows(spoilt, 0, 15, 0.5f);
  LoadedView masked = ViewOf("b.png", spoilt);
  masked.mask.assign(40 * 30, 1);
  std::fill_n(masked.mask.begin(), 40 * 15, uint8_t{0});
  const TestMetrics metrics = Evaluate(g, {ViewOf("a.png", spoilt), masked}, kOnGray, {"", Differing()}, Silent());
  const double whole = metrics.views[0].more.at("differing");
  EXPECT_GT(whole, 0);
  EXPECT_EQ(metrics.views[1].more.at("differing"), 0);
  EXPECT_EQ(metrics.more.at("differing"), whole / 2);
  const nlohmann::json json = ToJson(metrics);
  EXPECT_EQ(json.at("differing"), whole / 2);
  EXPECT_EQ(json.at("views")[0].at("differing"), whole);
  EXPECT_EQ(json.at("conventions").at("differing"), "share of the values that differ");
}

TEST(Evaluate, LeavesOutScoresForWhichAViewIsTooSmall) {
  ImageScores scores = Differing();
  scores.smallest_side = 31;
  std::vector<std::string> warnings;
  const TestMetrics metrics = Evaluate(RedBlob(), {ViewOf("a.png", Buffer<float>::Zeros({30, 40, 3}))}, kOnGray,
                                       {"", scores}, [&](const Event& event) {
                                         if (const auto* w = std::get_if<Warning>(&event)) warnings.push_back(w->text);
                                       });
  EXPECT_TRUE(metrics.more.empty() && metrics.conventions.empty());
  EXPECT_EQ(warnings, std::vector<std::string>{"a.png has 40 x 30 pixels, too few for differing, which is left out"});
}

TEST(Evaluate, WritesRendersBesideTheTruth) {
  const TempDir dir;
  const Gaussians g = RedBlob();
  Evaluate(g, {ViewOf("left/0001.jpg", Buffer<float>::Full({30, 40, 3}, 0.2f))}, kOnGray, dir / "renders", Silent());
  const Image8 render = ReadImage(dir / "renders" / "left_0001.png");
  const Image8 truth = ReadImage(dir / "renders" / "left_0001_gt.png");
  EXPECT_EQ(render.data, ToImage8(Rendered(g)).data);
  EXPECT_EQ(render.width, 40);
  EXPECT_EQ(truth.data, std::vector<uint8_t>(30 * 40 * 3, 51));
}

TEST(Evaluate, KeepsRendersOfViewsOfOneStemApart) {
  const TempDir dir;
  const auto gray = [](const char* name, float value) { return ViewOf(name, Buffer<float>::Full({30, 40, 3}, value)); };
  Evaluate(RedBlob(), {gray("1.jpg", 0.2f), gray("1.png", 0.4f)}, kOnGray, dir.path(), Silent());
  EXPECT_EQ(ReadImage(dir / "1_jpg_gt.png").data[0], 51);
  EXPECT_EQ(ReadImage(dir / "1_png_gt.png").data[0], 102);
}

TEST(Evaluate, StopsWhenAsked) {
  RequestInterrupt(true);
  EXPECT_THROW(Evaluate(RedBlob(), {ViewOf("a", Buffer<float>::Zeros({30, 40, 3}))}, kOnGray, {}, Silent()),
               Interrupted);
  RequestInterrupt(false);
}

TEST(Evaluate, GivesNullMeansWithoutAnyPixelToScore) {
  LoadedView masked = ViewOf("nothing.png", Buffer<float>::Zeros({30, 40, 3}));
  masked.mask.assign(40 * 30, 0);
  for (const auto& views : {std::vector<LoadedView>{}, std::vector<LoadedView>{masked}}) {
    const TestMetrics metrics = Evaluate(RedBlob(), views, kOnGray, {}, Silent());
    EXPECT_TRUE(metrics.views.empty());
    EXPECT_TRUE(std::isnan(metrics.psnr));
    EXPECT_EQ(ToJson(metrics).dump(), R"({"psnr":null,"psnr_color_corrected":null,"ssim":null,"views":[]})");
  }
}

TEST(EvaluateToJson, HasTheKeysOfMetricsJson) {
  TestMetrics metrics;
  metrics.psnr = 20, metrics.ssim = 0.5, metrics.psnr_color_corrected = 21;
  metrics.views = {{"a.png", 20, 0.5, 21}};
  EXPECT_EQ(ToJson(metrics).dump(),
            R"({"psnr":20.0,"psnr_color_corrected":21.0,"ssim":0.5,"views":[{"name":"a.png","psnr":20.0,)"
            R"("psnr_color_corrected":21.0,"ssim":0.5}]})");
}

TEST(ImageConversion, RoundTripsAndRefusesOtherChannels) {
  const auto image = Buffer<float>::Empty({7, 9, 3});
  for (int64_t i = 0; i < image.count(); ++i) image[i] = static_cast<float>(i % 256) / 255.f;
  EXPECT_LT(MaxAbsError(ToBuffer(ToFloat(ToImage8(image))), image), 1e-7);
  EXPECT_THROW(ToBuffer(ImageF{2, 2, 1, std::vector<float>(4)}), ShapeError);
  EXPECT_THROW(ToImage8(Buffer<float>::Zeros({4, 4})), ShapeError);
  const auto wild = Buffer<float>::From({1, 1, 3}, {-3.f, 0.5f, 9.f});
  EXPECT_EQ(ToImage8(wild).data, (std::vector<uint8_t>{0, 128, 255}));
}

}  // namespace
}  // namespace oraclegs
