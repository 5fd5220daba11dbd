#include "oraclegs/propose/fill_holes.h"

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

TEST(PushPull, KeepsKnownAndFillsFromNeighbors) {
  ImageF image{13, 7, 3, std::vector<float>(13 * 7 * 3, 0.f)};
  std::vector<float> weight(13 * 7, 0.f);
  const auto set = [&](int x, int y, float red, float green) {
    weight[static_cast<size_t>(y) * 13 + x] = 1;
    image.row(y)[3 * x] = red, image.row(y)[3 * x + 1] = green;
  };
  for (int y = 0; y < 7; ++y) set(0, y, 1.f, 0.25f), set(12, y, 0.f, 0.25f);
  PushPull(weight, &image);
  EXPECT_EQ(image.row(3)[0], 1.f);
  EXPECT_EQ(image.row(3)[3 * 12], 0.f);
  EXPECT_GT(image.row(3)[3 * 2], 0.6f);   // near the red side
  EXPECT_LT(image.row(3)[3 * 10], 0.4f);  // near the other
  for (int x = 0; x < 13; ++x) EXPECT_NEAR(image.row(3)[3 * x + 1], 0.25f, 1e-6f) << x;
}

TEST(PushPull, BlendsPartialWeights) {
  ImageF image{2, 1, 1, {1.f, 0.f}};
  PushPull({1.f, 0.5f}, &image);
  EXPECT_EQ(image.data[0], 1.f);
  EXPECT_GT(image.data[1], 0.1f);
  EXPECT_LT(image.data[1], 0.5f);
}

TEST(PushPull, KeepsImageWithoutWeights) {
  ImageF image{3, 3, 1, std::vector<float>(9, 0.5f)};
  PushPull(std::vector<float>(9, 0.f), &image);
  EXPECT_EQ(image.data, std::vector<float>(9, 0.5f));
}

}  // namespace
}  // namespace oraclegs
