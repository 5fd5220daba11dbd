#include "oraclegs/loss/depth_losses.h"

#include <gtest/gtest.h>

#include <set>

namespace oraclegs {
namespace {

TEST(RandomPatches, LieInsideAndFollowSeedAndIteration) {
  const PatchSampling sampling{16, 0.5};
  const auto corners = [&](uint64_t seed, int64_t iteration) {
    std::vector<std::pair<int64_t, int64_t>> all;
    for (const ImagePatch& p : RandomPatches(70, 100, sampling, seed, iteration)) {
      EXPECT_EQ(p.width, 16);
      EXPECT_EQ(p.height, 16);
      EXPECT_TRUE(p.x >= 0 && p.y >= 0 && p.x + 16 <= 100 && p.y + 16 <= 70);
      all.emplace_back(p.x, p.y);
    }
    return all;
  };
  EXPECT_EQ(corners(1, 5).size(), 12U);  // half of 4 x 6, rounded down
  EXPECT_EQ(corners(1, 5), corners(1, 5));
  EXPECT_NE(corners(1, 5), corners(2, 5));
  EXPECT_NE(corners(1, 5), corners(1, 6));
}

TEST(RandomPatches, ReachEveryPlace) {
  std::set<std::pair<int64_t, int64_t>> corners;
  for (int64_t iteration = 0; iteration < 300; ++iteration) {
    for (const ImagePatch& p : RandomPatches(6, 5, {4, 1}, 3, iteration)) corners.insert({p.x, p.y});
  }
  EXPECT_EQ(corners.size(), 6U);  // 2 columns, 3 rows
}

TEST(RandomPatches, AreCutToSmallImages) {
  const auto patches = RandomPatches(9, 30, {16, 0.5}, 1, 1);
  ASSERT_EQ(patches.size(), 1U);
  EXPECT_EQ(patches[0].height, 9);
  EXPECT_EQ(patches[0].width, 16);
  EXPECT_THROW(RandomPatches(9, 30, {0, 0.5}, 1, 1), ShapeError);
  EXPECT_THROW(RandomPatches(0, 30, {4, 0.5}, 1, 1), ShapeError);
}

TEST(GridPatches, LeaveOutWhatIsNoWholePatch) {
  const auto patches = GridPatches(11, 7, 3);
  ASSERT_EQ(patches.size(), 6U);
  EXPECT_EQ(patches.back().x, 3);
  EXPECT_EQ(patches.back().y, 6);
  EXPECT_EQ(GridPatches(2, 5, 3).size(), 1U);  // one row of whole columns
  EXPECT_THROW(GridPatches(2, 5, 0), ShapeError);
}

}  // namespace
}  // namespace oraclegs
