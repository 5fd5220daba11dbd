#include "oraclegs/demo/noise.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace oraclegs
