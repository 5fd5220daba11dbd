#include "oraclegs/evaluate/rank_statistics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace oraclegs {
namespace {

using testing::ElementsAre;

TEST(RisingOrder, KeepsTheOrderOfEqualValues) {
  EXPECT_THAT(RisingOrder({0.5f, 0.1f, 0.5f, 0.3f}), ElementsAre(1, 3, 0, 2));
}

TEST(Ranks, ShareTheMeanAmongTies) { EXPECT_THAT(Ranks({0.5f, 0.1f, 0.5f, 0.9f}), ElementsAre(2.5, 1, 2.5, 4)); }

TEST(Correlation, OfThreePairsByHand) {
  // Deviations -1 0 1 and -1 1 0: products sum to 1, squares to 2 and 2.
  EXPECT_DOUBLE_EQ(Correlation({1, 2, 3}, {1, 3, 2}), 0.5);
  EXPECT_DOUBLE_EQ(Correlation({1, 2, 3}, {3, 2, 1}), -1);
  EXPECT_EQ(Correlation({1, 2, 3}, {5, 5, 5}), 0);
}

TEST(AurocOfLowRank, CountsPairsInOrder) {
  // Positives have ranks 1 and 2.5, negatives 2.5 and 4: all pairs but one are in order, that one is a tie.
  EXPECT_DOUBLE_EQ(AurocOfLowRank({2.5, 1, 2.5, 4}, {true, true, false, false}), 3.5 / 4);
  EXPECT_DOUBLE_EQ(AurocOfLowRank({1, 2, 3}, {false, false, true}), 0);
  EXPECT_TRUE(std::isnan(AurocOfLowRank({1, 2}, {true, true})));
  EXPECT_TRUE(std::isnan(AurocOfLowRank({1, 2}, {false, false})));
}

}  // namespace
}  // namespace oraclegs
