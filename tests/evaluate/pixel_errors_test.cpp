#include "oraclegs/evaluate/pixel_errors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace oraclegs {
namespace {

constexpr int kErrorsSide = 16;

/// A render of gray levels that rise to the right, and the same as a view.
struct RenderAndView {
  RenderOutput render;
  LoadedView view;

  RenderAndView() {
    render.image = Buffer<float>::Zeros({kErrorsSide, kErrorsSide, 3});
    render.alpha = Buffer<float>::Full({kErrorsSide, kErrorsSide}, 1.f);
    for (int64_t i = 0; i < render.image.count(); ++i) {
      render.image[i] =
          0.3f + 0.4f * static_cast<float>(i / 3 % kErrorsSide) / kErrorsSide + 0.1f * static_cast<float>(i % 3);
    }
    view.camera.width = view.camera.height = kErrorsSide;
    view.rgb = {kErrorsSide, kErrorsSide, 3, {render.image.span().begin(), render.image.span().end()}};
  }
};

TEST(ErrorsOf, LeavesOutWhatIsMaskedOrNotDrawn) {
  RenderAndView pair;
  pair.render.alpha[3] = 0.05f;
  pair.view.mask.assign(kErrorsSide * kErrorsSide, 255);
  pair.view.mask[7] = 0;
  const PixelErrors errors = ErrorsOf(pair.render, pair.view);
  EXPECT_EQ(errors.at.size(), kErrorsSide * kErrorsSide - 2);
  EXPECT_EQ(std::count(errors.at.begin(), errors.at.end(), 3), 0);
  EXPECT_EQ(std::count(errors.at.begin(), errors.at.end(), 7), 0);
  EXPECT_EQ(ErrorsOf(pair.render, pair.view, 4).at.size(), kErrorsSide * kErrorsSide / 4);
  for (const std::vector<float>* list : {&errors.error, &errors.absolute, &errors.dssim}) {
    ASSERT_EQ(list->size(), errors.at.size());
    for (const float e : *list) EXPECT_NEAR(e, 0, 1e-3);
  }
}

TEST(ErrorsOf, FindsTheErrorThatNoExposureExplains) {
  RenderAndView pair;
  for (float& value : pair.view.rgb.data) value *= 0.8f;  // another exposure
  const int64_t wrong = 8 * kErrorsSide + 8;
  pair.view.rgb.data[3 * wrong] += 0.3f;  // one channel of one pixel
  const PixelErrors errors = ErrorsOf(pair.render, pair.view);
  const size_t at = static_cast<size_t>(wrong);
  EXPECT_NEAR(errors.error[at], 0.3 / std::sqrt(3), 0.01);
  EXPECT_NEAR(errors.absolute[at], 0.1, 0.01);
  EXPECT_GT(errors.dssim[at], 0.05);
  EXPECT_NEAR(errors.error[0], 0, 0.01);
  EXPECT_NEAR(errors.dssim[0], 0, 0.01);  // out of the window's reach
}

}  // namespace
}  // namespace oraclegs
