#include "oraclegs/evaluate/uncertainty.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace oraclegs {
namespace {

constexpr int kSide = 32;
constexpr float kNoise = 0.007f;  // of photos

Camera WideCamera() {
  Camera camera;
  camera.width = camera.height = kSide;
  camera.fx = camera.fy = 40;
  camera.cx = camera.cy = kSide / 2.0;
  return camera;
}

/// Gray balls at the left and the right of the picture, and one behind the camera.
Gaussians ThreeBalls() {
  Gaussians g = Gaussians::Zeros(3);
  for (int64_t i = 0; i < 3; ++i) {
    g.means[3 * i] = i == 0 ? -0.6f : 0.6f, g.means[3 * i + 2] = i == 2 ? -3 : 3;
    g.quats[4 * i] = 1;
    std::fill_n(g.log_scales.data() + 3 * i, 3, std::log(0.15f));
    g.opacity_logits[i] = 6;
  }
  return g;
}

/// Those balls, with the right one brighter by `more`.
Gaussians WithBrighterRight(float more) {
  Gaussians g = ThreeBalls().Clone();
  for (int64_t c = 0; c < 3; ++c) g.sh[kShFloats + c] = more / static_cast<float>(kConstantSh);
  return g;
}

float AtPixel(const std::vector<float>& values, int x, int y) {
  return values[static_cast<size_t>(y) * kSide + static_cast<size_t>(x)];
}

TEST(Uncertainty, IsWhereModelsDiffer) {
  const Gaussians model = ThreeBalls();
  Uncertainty uncertainty(model, {WithBrighterRight(0.05f), WithBrighterRight(-0.05f)}, {});
  const std::vector<float> at = uncertainty.At(WideCamera());
  EXPECT_NEAR(AtPixel(at, 8, 16), kNoise, 1e-5f) << "the models agree";
  EXPECT_EQ(AtPixel(at, 16, 2), kNoise) << "nothing is there";
  // Deviation of 0, .05 and -.05 is .041, and errors are more than twice as large.
  EXPECT_GT(AtPixel(at, 24, 16), 0.06f);
  EXPECT_LT(AtPixel(at, 24, 16), 0.12f);
}

TEST(Uncertainty, OfGaussiansIsThatOfThePixelsThatShowThem) {
  const Gaussians model = ThreeBalls();
  Uncertainty uncertainty(model, {WithBrighterRight(0.05f), WithBrighterRight(-0.05f)}, {});
  const std::vector<float> of = uncertainty.OfGaussians({WideCamera(), WideCamera()});
  ASSERT_EQ(of.size(), 3u);
  EXPECT_NEAR(of[0], kNoise, 1e-3f);
  EXPECT_GT(of[1], 0.05f);
  EXPECT_EQ(of[2], of[1]) << "not seen: as little certain as the others get";
  EXPECT_EQ(Uncertainty(model, {}, {}).OfGaussians({})[0], 1) << "nothing is known where no view is";
}

TEST(Uncertainty, TheModelStandsInForOthers) {
  // Balls in a row: 30 % are left out of a stand-in, and their places are unsure.
  constexpr int kBalls = 12;
  Gaussians model = Gaussians::Zeros(kBalls);
  for (int64_t i = 0; i < kBalls; ++i) {
    model.means[3 * i] = 0.15f * (static_cast<float>(i) - 5.5f), model.means[3 * i + 2] = 3;
    model.quats[4 * i] = 1;
    std::fill_n(model.log_scales.data() + 3 * i, 3, std::log(0.08f));
    model.opacity_logits[i] = 2;
  }
  const std::vector<float> at = Uncertainty(model, {}, {}).At(WideCamera());
  EXPECT_EQ(at, Uncertainty(model, {}, {}).At(WideCamera())) << "always the same";
  EXPECT_EQ(AtPixel(at, 16, 2), kNoise) << "nothing is there";
  EXPECT_GT(*std::max_element(at.begin(), at.end()), 0.2f) << "a ball that is left out changes the picture";
}

}  // namespace
}  // namespace oraclegs
