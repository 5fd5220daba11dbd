#include "oraclegs/propose/push_pull.h"

#include <gtest/gtest.h>

namespace oraclegs {
namespace {

TEST(PushPull, KeepsKnownAndFillsFromNeighbours) {
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
