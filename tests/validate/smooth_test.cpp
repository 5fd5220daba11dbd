#include "oraclegs/validate/smooth.h"

#include <gtest/gtest.h>

#include <cmath>

#include "oraclegs/core/error.h"

namespace oraclegs {
namespace {

TEST(Smooth, WhatIsTheSameEverywhereStays) {
  ConfidenceMap map(7 * 4, 0.375f);
  Smooth(7, 4, &map);
  for (const float trust : map) EXPECT_FLOAT_EQ(trust, 0.375f);
}

TEST(Smooth, APixelSpreadsToTheFiveByFiveAroundIt) {
  ConfidenceMap map(9 * 10, 0);
  map[4 * 9 + 4] = 1;
  Smooth(9, 10, &map);
  constexpr float kTaps[] = {1, 4, 6, 4, 1};
  for (int y = 0; y < 10; ++y) {
    for (int x = 0; x < 9; ++x) {
      const bool near = std::abs(x - 4) <= 2 && std::abs(y - 4) <= 2;
      const float expected = near ? kTaps[x - 2] * kTaps[y - 2] / 256 : 0;
      EXPECT_NEAR(map[static_cast<size_t>(y * 9 + x)], expected, 1e-7) << x << ' ' << y;
    }
  }
}

TEST(Smooth, AtTheBorderOnlyWhatLiesWithinCounts) {
  ConfidenceMap row = {1, 0, 0, 0};
  Smooth(4, 1, &row);
  EXPECT_FLOAT_EQ(row[0], 6.f / 11);
  EXPECT_FLOAT_EQ(row[1], 4.f / 15);
  EXPECT_FLOAT_EQ(row[2], 1.f / 15);
  EXPECT_EQ(row[3], 0);
  ConfidenceMap column = {1, 0, 0, 0};
  Smooth(1, 4, &column);
  EXPECT_EQ(column, row);
}

TEST(Smooth, RefusesAMapOfAnotherSize) {
  ConfidenceMap map(5);
  EXPECT_THROW(Smooth(2, 2, &map), ShapeError);
}

}  // namespace
}  // namespace oraclegs
