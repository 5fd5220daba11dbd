#include "oraclegs/output/report/value_images.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "oraclegs/evaluate/uncertainty.h"
#include "oraclegs/image/colormap.h"
#include "oraclegs/render/recolor.h"
#include "support/errors.h"

namespace oraclegs {
namespace {

constexpr int kWallSide = 32;

/// A wall of overlapping flat Gaussians; its left half is at depth 2, its right half at depth 4.
Model Wall() {
  constexpr int kCount = 24;
  Model model;
  model.gaussians = Gaussians::Zeros(kCount * kCount);
  const GaussianRows all = model.gaussians.Rows();
  for (int i = 0; i < kCount * kCount; ++i) {
    const GaussianRows row = all.From(i);
    const float x = (static_cast<float>(i % kCount) + 0.5f) / kCount - 0.5f;
    const float y = (static_cast<float>(i / kCount) + 0.5f) / kCount - 0.5f;
    const float z = x < 0 ? 2 : 4;
    row.means[0] = 1.2f * x * z, row.means[1] = 1.2f * y * z, row.means[2] = z;
    const float size = std::log(0.05f * z);
    row.log_scales[0] = size, row.log_scales[1] = size, row.log_scales[2] = size - 5;
    row.quats[0] = 1;
    row.opacity_logits[0] = 6;
  }
  model.marks.support.assign(static_cast<size_t>(kCount * kCount), 1);
  model.marks.uncertainty.resize(static_cast<size_t>(kCount * kCount));
  for (int i = 0; i < kCount * kCount; ++i) {
    model.marks.uncertainty[static_cast<size_t>(i)] = all.From(i).means[0] < 0 ? 0 : kLargestShownError;
  }
  return model;
}

Camera WallCamera() {
  return {kWallSide, kWallSide, kWallSide, kWallSide, kWallSide / 2.0, kWallSide / 2.0, Eigen::Isometry3d::Identity()};
}

std::array<int, 3> PixelAt(const Image8& image, int x, int y) {
  const uint8_t* pixel = image.data.data() + 3 * (y * image.width + x);
  return {pixel[0], pixel[1], pixel[2]};
}

TEST(ParseRenderValues, ReadsAList) {
  EXPECT_THAT(ParseRenderValues("depth,color,depth"), testing::ElementsAre(RenderValue::kDepth, RenderValue::kColor));
  for (const char* bad : {"", "depth,", "depth color", "Depth"}) EXPECT_THROW(ParseRenderValues(bad), UsageError);
}

TEST(ValueRenderer, ShowsDepthNormalsAndSupport) {
  const Model model = Wall();
  ValueRenderer renderer(model, {RenderValue::kSupport, RenderValue::kDepth, RenderValue::kNormals},
                         {WallCamera(), WallCamera()});
  const std::vector<Image8> images = renderer.Render(WallCamera());
  ASSERT_EQ(images.size(), 3u);
  const auto near = PixelAt(images[1], 6, 16), far = PixelAt(images[1], 26, 16);
  EXPECT_GT(near[0], 200) << "near is yellow";
  EXPECT_GT(near[1], 200);
  EXPECT_LT(far[1], 60) << "far is dark purple";
  const auto normal = PixelAt(images[2], 6, 16);
  EXPECT_NEAR(normal[0], 128, 12);
  EXPECT_NEAR(normal[1], 128, 12);
  EXPECT_LT(normal[2], 6) << "towards the camera";
  const auto support = PixelAt(images[0], 6, 16);
  const auto color = ColorOf(SupportClass::kSeenByTwo);
  for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(support[c], color[c], 6);
}

TEST(ValueRenderer, ShowsUncertaintyInTheColorsOfErrors) {
  const Model model = Wall();
  ValueRenderer renderer(model, {RenderValue::kUncertainty}, {});
  Camera away = WallCamera();
  away.cam_from_world.linear().col(0) *= -1, away.cam_from_world.linear().col(2) *= -1;  // turned around
  const Image8 image = renderer.Render(WallCamera())[0], empty = renderer.Render(away)[0];
  for (const auto& [x, error] : {std::pair(6, 0.f), std::pair(26, 1.f)}) {
    const auto expected = MapColor(ColorMap::kPlasma, error);
    for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(PixelAt(image, x, 16)[c], expected[c], 6) << x;
  }
  const auto none = MapColor(ColorMap::kPlasma, 0);
  for (size_t c = 0; c < 3; ++c) EXPECT_EQ(PixelAt(empty, 16, 16)[c], none[c]) << "nothing is drawn";
  // Where other models are known, they are asked, and not the marks.
  Model among_others = Wall();
  among_others.others = {among_others.gaussians};
  const Image8 agreed = ValueRenderer(among_others, {RenderValue::kUncertainty}, {}).Render(WallCamera())[0];
  const auto noise = MapColor(ColorMap::kPlasma, 0.007 / kLargestShownError);  // what models agree on errs by no more
  for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(PixelAt(agreed, 26, 16)[c], noise[c], 1);
}

TEST(ValueRenderer, RefusesMarksThatAreNotKnown) {
  Model model = Wall();
  model.marks = {};
  EXPECT_THAT(MessageOf<InputError>([&] { ValueRenderer(model, {RenderValue::kUncertainty}, {WallCamera()}); }),
              testing::HasSubstr("uncertainty"));
  EXPECT_THAT(MessageOf<InputError>([&] { ValueRenderer(model, {RenderValue::kSupport}, {WallCamera()}); }),
              testing::HasSubstr("support"));
}

}  // namespace
}  // namespace oraclegs
