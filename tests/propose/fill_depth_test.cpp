#include "oraclegs/propose/fill_depth.h"

#include <gtest/gtest.h>

namespace oraclegs {
namespace {

TEST(FillDepth, ContinuesFartherSide) {
  // Near (4) on the left, far (1) on the right, a gap of two columns between.
  const int width = 8, height = 5;
  std::vector<float> inv_depth;
  std::vector<uint8_t> to_fill;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const bool gap = x == 3 || x == 4;
      inv_depth.push_back(gap ? 0.f : x < 3 ? 4.f : 1.f);
      to_fill.push_back(gap ? 1 : 0);
    }
  }
  const std::vector<float> rings = FillDepth(width, height, to_fill, &inv_depth);
  for (int y = 0; y < height; ++y) {
    EXPECT_EQ(inv_depth[static_cast<size_t>(y * width + 3)], 1.f);
    EXPECT_EQ(inv_depth[static_cast<size_t>(y * width + 4)], 1.f);
    EXPECT_EQ(inv_depth[static_cast<size_t>(y * width + 2)], 4.f);
    EXPECT_EQ(rings[static_cast<size_t>(y * width + 2)], 0.f);
    EXPECT_GT(rings[static_cast<size_t>(y * width + 3)], 0.f);
  }
}

TEST(FillDepth, RingsGrowWithDistance) {
  const int width = 20, height = 1;
  std::vector<float> inv_depth(20, 0.f);
  inv_depth[0] = 2;
  std::vector<uint8_t> to_fill(20, 1);
  to_fill[0] = 0;
  for (size_t x = 15; x < 20; ++x) to_fill[x] = 0;
  const std::vector<float> rings = FillDepth(width, height, to_fill, &inv_depth);
  for (size_t x = 1; x < 15; ++x) {
    EXPECT_EQ(inv_depth[x], 2.f) << x;
    EXPECT_GE(rings[x], rings[x - 1]) << x;
  }
  EXPECT_GT(rings[14], rings[2]);
  for (size_t x = 15; x < 20; ++x) EXPECT_EQ(inv_depth[x], 0.f);
}

TEST(FillDepth, MarksUnreachedPixels) {
  std::vector<float> inv_depth(12, 0.f);
  EXPECT_EQ(FillDepth(4, 3, std::vector<uint8_t>(12, 1), &inv_depth), std::vector<float>(12, 7.f));
  EXPECT_EQ(inv_depth, std::vector<float>(12, 0.f));
}

}  // namespace
}  // namespace oraclegs
