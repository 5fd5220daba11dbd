#include "oraclegs/depth/patch_cost.h"

#include <gtest/gtest.h>

namespace oraclegs {
namespace {

TEST(Pack, HoldsFourPixelsInAWord) {
  ImageF image{3, 2, 2, {}};
  for (int i = 0; i < 6; ++i) {
    image.data.push_back(static_cast<float>(i) / 255);
    image.data.push_back(static_cast<float>(100 + i) / 255);
  }
  const GatherImage packed = Pack(image);
  EXPECT_EQ(packed.width, 3);
  EXPECT_EQ(packed.height, 2);
  ASSERT_EQ(packed.channels.size(), 2u);
  ASSERT_EQ(packed.channels[0].size(), 6u);
  const auto word = [](uint32_t here, uint32_t right, uint32_t below, uint32_t across) {
    return here | right << 8 | below << 16 | across << 24;
  };
  EXPECT_EQ(packed.channels[0][0], word(0, 1, 3, 4));
  EXPECT_EQ(packed.channels[1][1], word(101, 102, 104, 105));
  EXPECT_EQ(packed.channels[0][2], word(2, 2, 5, 5)) << "the last column repeats";
  EXPECT_EQ(packed.channels[0][3], word(3, 4, 3, 4)) << "the last row repeats";
  EXPECT_EQ(packed.channels[1][5], word(105, 105, 105, 105));
  EXPECT_EQ(packed.Value(1, 2, 1), 105);
  EXPECT_EQ(packed.Value(0, 0, 1), 3);
}

TEST(Pack, RoundsAndClamps) {
  const GatherImage packed = Pack({5, 1, 1, {-0.5f, 0.49f / 255, 0.51f / 255, 254.6f / 255, 7.f}});
  const std::vector<int> expected = {0, 0, 1, 255, 255};
  for (int x = 0; x < 5; ++x) EXPECT_EQ(packed.Value(0, x, 0), expected[static_cast<size_t>(x)]) << x;
}

TEST(Luma, UsesRec601Weights) {
  const ImageF luma = Luma({4, 1, 3, {1, 0, 0, 0, 1, 0, 0, 0, 1, 0.5f, 0.5f, 0.5f}});
  EXPECT_EQ(luma.channels, 1);
  ASSERT_EQ(luma.data.size(), 4u);
  EXPECT_FLOAT_EQ(luma.data[0], 0.299f);
  EXPECT_FLOAT_EQ(luma.data[1], 0.587f);
  EXPECT_FLOAT_EQ(luma.data[2], 0.114f);
  EXPECT_FLOAT_EQ(luma.data[3], 0.5f);
}

}  // namespace
}  // namespace oraclegs
