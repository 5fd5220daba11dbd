#include "oraclegs/demo/depth_sensor.h"

#include <gmock/gmock.h>

#include <cmath>

namespace oraclegs {
namespace {

TEST(SenseDepth, HasNoiseHolesAndDoubt) {
  constexpr int kWidth = 320, kHeight = 240;
  const SensedDepth sensed = SenseDepth(std::vector<uint16_t>(kWidth * kHeight, 3000), kWidth, kHeight, 4);
  ASSERT_EQ(sensed.width, kWidth / 2);
  ASSERT_EQ(sensed.height, kHeight / 2);
  ASSERT_EQ(sensed.depth.size(), sensed.confidence.data.size());
  double squares = 0, high = 0, holes = 0, doubtful = 0;
  for (size_t i = 0; i < sensed.depth.size(); ++i) {
    const double off = sensed.depth[i] - 3000.;
    if (sensed.confidence.data[i] == 255) squares += off * off, ++high;
    if (sensed.depth[i] == 0) ++holes;
    if (sensed.confidence.data[i] == 0 && sensed.depth[i] > 0) doubtful += std::abs(off - 300) < 30 ? 1 : 0;
  }
  const double all = static_cast<double>(sensed.depth.size());
  EXPECT_NEAR(std::sqrt(squares / high), 5, 0.2);
  EXPECT_GT(high, 0.6 * all);
  EXPECT_GT(holes, 0.02 * all);
  EXPECT_GT(doubtful, 0.02 * all);
  EXPECT_DOUBLE_EQ(high + holes + doubtful, all);
}

TEST(SenseDepth, BlursBreaks) {
  std::vector<uint16_t> truth(64 * 64, 2000);
  for (size_t i = 0; i < truth.size(); ++i) {
    if (i % 64 >= 33) truth[i] = 3000;
  }
  const SensedDepth sensed = SenseDepth(truth, 64, 64, 0);
  int breaks = 0;
  for (size_t i = 0; i < sensed.depth.size(); ++i) {
    const size_t x = i % 32;
    if (sensed.confidence.data[i] != 127) continue;
    EXPECT_EQ(x, 16u);
    EXPECT_NEAR(sensed.depth[i], 2500, 30);
    ++breaks;
  }
  EXPECT_GT(breaks, 0);
}

}  // namespace
}  // namespace oraclegs
