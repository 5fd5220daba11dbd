#include "oraclegs/core/bfloat16.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace oraclegs {
namespace {

TEST(Bfloat16, EveryNumberComesBack) {
  for (uint32_t bits = 0; bits < 0x10000; ++bits) {
    const float value = FromBfloat16(static_cast<uint16_t>(bits));
    if (std::isnan(value)) continue;
    EXPECT_EQ(ToBfloat16(value), bits);
  }
}

TEST(Bfloat16, RoundsToTheNearestAndOfTwoToTheEven) {
  const auto rounded = [](float value) { return FromBfloat16(ToBfloat16(value)); };
  EXPECT_EQ(rounded(1 + 0x1p-9f), 1);
  EXPECT_EQ(rounded(1 + 0x1p-8f), 1);  // in the middle
  EXPECT_EQ(rounded(1 + 0x1p-8f + 0x1p-20f), 1 + 0x1p-7f);
  EXPECT_EQ(rounded(1 + 3 * 0x1p-8f), 1 + 0x1p-6f);  // in the middle
  EXPECT_EQ(rounded(-1 - 3 * 0x1p-9f), -1 - 0x1p-7f);
  EXPECT_EQ(rounded(std::numeric_limits<float>::max()), std::numeric_limits<float>::infinity());
  EXPECT_EQ(rounded(-std::numeric_limits<float>::infinity()), -std::numeric_limits<float>::infinity());
  EXPECT_TRUE(std::signbit(rounded(-0.f)));
}

}  // namespace
}  // namespace oraclegs
