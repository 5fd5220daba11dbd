#include "oraclegs/image/colormap.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>

namespace oraclegs {
namespace {

using Rgb = std::array<uint8_t, 3>;

/// Relative luminance of an sRGB color.
double Luminance(const Rgb& color) {
  const auto linear = [](uint8_t c) { return std::pow(c / 255.0, 2.2); };
  return 0.2126 * linear(color[0]) + 0.7152 * linear(color[1]) + 0.0722 * linear(color[2]);
}

TEST(MapColor, HasMatplotlibsColors) {
  EXPECT_EQ(MapColor(ColorMap::kPlasma, 0), (Rgb{0x0d, 0x08, 0x87}));
  EXPECT_EQ(MapColor(ColorMap::kPlasma, 0.5f), (Rgb{0xcc, 0x47, 0x78}));
  EXPECT_EQ(MapColor(ColorMap::kPlasma, 1), (Rgb{0xf0, 0xf9, 0x21}));
  EXPECT_EQ(MapColor(ColorMap::kViridis, 0), (Rgb{0x44, 0x01, 0x54}));
  EXPECT_EQ(MapColor(ColorMap::kViridis, 0.5f), (Rgb{0x21, 0x91, 0x8c}));
  EXPECT_EQ(MapColor(ColorMap::kViridis, 1), (Rgb{0xfd, 0xe7, 0x25}));
}

TEST(MapColor, IsBrighterForMoreInSmallSteps) {
  for (const ColorMap map : {ColorMap::kPlasma, ColorMap::kViridis}) {
    for (int i = 1; i < 256; ++i) {
      const Rgb before = MapColor(map, static_cast<float>(i - 1) / 255),
                now = MapColor(map, static_cast<float>(i) / 255);
      EXPECT_GT(Luminance(now), Luminance(before) - 1e-3) << i;
      for (int c = 0; c < 3; ++c) EXPECT_LE(std::abs(now[c] - before[c]), 6) << i;
    }
  }
}

TEST(MapColor, ValuesBeyondTheEndsHaveTheirColor) {
  for (const ColorMap map : {ColorMap::kPlasma, ColorMap::kViridis}) {
    EXPECT_EQ(MapColor(map, -3), MapColor(map, 0));
    EXPECT_EQ(MapColor(map, 9), MapColor(map, 1));
    EXPECT_EQ(MapColor(map, std::numeric_limits<float>::infinity()), MapColor(map, 1));
    EXPECT_EQ(MapColor(map, std::numeric_limits<float>::quiet_NaN()), MapColor(map, 0));
  }
}

}  // namespace
}  // namespace oraclegs
