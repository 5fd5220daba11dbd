#include "oraclegs/demo/textures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace oraclegs {
namespace {

TEST(ValueNoise, MeetsTheLatticeAndIsContinuous) {
  EXPECT_EQ(ValueNoise({3, -2, 7}, 5), LatticeNoise(3, -2, 7, 5));
  for (double x = -1.5; x < 1.5; x += .01) {
    EXPECT_LT(std::abs(ValueNoise({x, .3, .7}, 5) - ValueNoise({x + 1e-6, .3, .7}, 5)), 1e-5);
  }
}

TEST(LatticeNoise, IsUniformAndUncorrelated) {
  double sum = 0, squares = 0, product = 0;
  constexpr int kSide = 100;
  for (int i = 0; i < kSide; ++i) {
    for (int j = 0; j < kSide; ++j) {
      const double a = LatticeNoise(i, j, 0, 1) - .5, b = LatticeNoise(i + 1, j, 0, 1) - .5;
      sum += a;
      squares += a * a;
      product += a * b;
    }
  }
  constexpr double kCount = kSide * kSide;
  EXPECT_NEAR(sum / kCount, 0, .01);
  EXPECT_NEAR(squares / kCount, 1.0 / 12, .003);
  EXPECT_NEAR(product / kCount, 0, .003);
}

TEST(FractalNoise, StaysInTheUnitInterval) {
  for (int i = 0; i < 1000; ++i) {
    const double v = FractalNoise({.37 * i, -.11 * i, .05 * i}, 5, 3);
    EXPECT_GE(v, 0);
    EXPECT_LT(v, 1);
  }
}

TEST(Albedo, EveryTextureIsInRangeAndHasDetail) {
  const Vec3 size{.4, .4, .4};
  for (const Texture texture : {Texture::kRoom, Texture::kCrate, Texture::kQuilt, Texture::kMarble, Texture::kCandy,
                                Texture::kTiles, Texture::kDonut, Texture::kGlaze}) {
    double lowest = 1, highest = 0;
    for (int i = 0; i < 400; ++i) {
      const Vec3 p{-.35 + .035 * (i % 20), -.4, -.35 + .035 * (i / 20)};
      const Vec3 color = Albedo(texture, p, {0, -1, 0}, size);
      for (const double v : {color.x, color.y, color.z}) {
        ASSERT_GE(v, 0);
        ASSERT_LE(v, 1);
      }
      lowest = std::min(lowest, color.y);
      highest = std::max(highest, color.y);
    }
    EXPECT_GT(highest - lowest, .15) << static_cast<int>(texture);
  }
}

}  // namespace
}  // namespace oraclegs
