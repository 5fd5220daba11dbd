#include "oraclegs/formats/linear_colors.h"

#include "formats/splats.h"

namespace oraclegs {
namespace {

float ColorOf(float sh) { return 0.5f + static_cast<float>(kConstantSh) * sh; }

TEST(SrgbOfLinear, IsTheCurveOfTheStandard) {
  EXPECT_EQ(SrgbOfLinear(0), 0);
  EXPECT_NEAR(SrgbOfLinear(1), 1, 1e-6);
  EXPECT_NEAR(SrgbOfLinear(0.5f), 0.7353570f, 1e-6);
  EXPECT_NEAR(SrgbOfLinear(0.002f), 0.02584f, 1e-6);
  EXPECT_LT(SrgbOfLinear(-0.1f), 0);
}

TEST(ColorsFromLinear, IsExactForOneColor) {
  const Gaussians g = PlausibleGaussians(50), linear = HostCopy(g, 0);
  Gaussians display = HostCopy(g, 0);
  ColorsFromLinear(0, &display);
  for (int64_t i = 0; i < 50; ++i) {
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(ColorOf(display.sh[i * kShFloats + c]), SrgbOfLinear(ColorOf(linear.sh[i * kShFloats + c])), 1e-5);
    }
  }
}

TEST(ColorsFromLinear, ChangesWithTheDirectionAsTheCurveDoes) {
  Gaussians g = Gaussians::Zeros(1);
  g.sh[3] = 0.3f;  // red along y
  const float factor = std::sqrt(3 / (4 * 3.14159265f));
  const float up = SrgbOfLinear(0.5f + 0.3f * factor), down = SrgbOfLinear(0.5f - 0.3f * factor);
  ColorsFromLinear(1, &g);
  EXPECT_NEAR(ColorOf(g.sh[0]) + g.sh[3] * factor, up, 0.01f);
  EXPECT_NEAR(ColorOf(g.sh[0]) - g.sh[3] * factor, down, 0.01f);
  EXPECT_EQ(g.sh[4], 0);
}

TEST(LinearColors, WarningsNameTheFileInOneLine) {
  EXPECT_THAT(LinearColorsConverted("f"), testing::HasSubstr("f: its colors are linear"));
  EXPECT_THAT(UnknownColorSpace("a\nb", "sRGB", "f"), testing::HasSubstr("\"a\\nb\", which is not known"));
}

}  // namespace
}  // namespace oraclegs
