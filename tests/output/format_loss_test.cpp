#include "oraclegs/output/format_loss.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "formats/splats.h"

namespace oraclegs {
namespace {

TEST(PsnrFromAround, IsInfiniteForTheSameInAnyOrder) {
  const Gaussians g = PlausibleGaussians(200);
  Flat(g.opacity_logits) = 4.f;
  EXPECT_EQ(PsnrFromAround(g, g, {}), INFINITY);
}

/// A round Gaussian of size 1 that is as bright as this in red, gray in the rest.
Gaussians OfRed(float red) {
  Gaussians g = Gaussians::Zeros(1);
  g.quats[0] = 1;
  g.opacity_logits[0] = 20;
  g.sh[0] = (red - 0.5f) / static_cast<float>(kConstantSh);
  return g;
}

TEST(PsnrFromAround, IsThatOfTheErrorTimesItsShareOfThePixels) {
  // From 6 sizes away a pixel is 6 / 346 sizes. alpha = exp(-r^2 / 2), cut at 0.99, has a mean square of about pi over
  // the square of 6.93 sizes, and red is one channel of three.
  const double share = std::numbers::pi / (6.93 * 6.93) / 3;
  EXPECT_NEAR(PsnrFromAround(OfRed(0.6f), OfRed(0.5f), {}), -10 * std::log10(0.1 * 0.1 * share), 0.3);
  EXPECT_NEAR(PsnrFromAround(OfRed(0.7f), OfRed(0.5f), {}), -10 * std::log10(0.2 * 0.2 * share), 0.3);
}

TEST(PsnrFromAround, FallsWithTheError) {
  const Gaussians g = PlausibleGaussians(500);
  Flat(g.opacity_logits) = 4.f;
  double last = INFINITY;
  for (const float step : {0.001f, 0.01f, 0.1f}) {
    const Gaussians moved = PlausibleGaussians(500);
    Flat(moved.opacity_logits) = 4.f;
    Flat(moved.means) += step;
    const double psnr = PsnrFromAround(moved, g, {});
    EXPECT_LT(psnr, last - 5);
    last = psnr;
  }
}

TEST(PsnrFromAround, OfGaussiansAtOnePlaceFarOnesAndHiddenOnes) {
  const Gaussians g = PlausibleGaussians(3), faint = PlausibleGaussians(3);
  Flat(g.means) = 1.f;
  EXPECT_EQ(PsnrFromAround(g, g, {}), INFINITY);
  for (int64_t i = 0; i < 9; ++i) g.means[i] = (i % 2 == 0 ? 1.f : -1.f) * std::numeric_limits<float>::max();
  EXPECT_EQ(PsnrFromAround(g, g, {}), INFINITY);
  Flat(faint.opacity_logits) = -9.f;
  EXPECT_EQ(PsnrFromAround(faint, faint, {}), INFINITY);
}

TEST(LossOfScore, AddsSquaresOfErrors) {
  EXPECT_NEAR(LossOfScore(30, 30), 3.0103, 1e-4);  // twice the squares
  EXPECT_NEAR(LossOfScore(30, 50), 0.0432, 1e-4);
  EXPECT_EQ(LossOfScore(30, INFINITY), 0);
}

}  // namespace
}  // namespace oraclegs
