#include "oraclegs/sfm/choose_pairs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace oraclegs {
namespace {

TEST(PairsToMatch, IsAllOfFewAndAFewOfMany) {
  EXPECT_EQ(PairsToMatch(2), 1);
  EXPECT_EQ(PairsToMatch(60), 1770);
  EXPECT_LE(PairsToMatch(61), 61 * 14);
  EXPECT_LE(PairsToMatch(292), 292 * 14) << "of 42486";
}

TEST(ChoosePairs, TakesNeighborsAndWhatLooksAlike) {
  // Two rounds of 50 photos on one circle, in order: i and i + 50 look alike.
  constexpr int kImages = 100;
  Eigen::MatrixXf descriptions(kImages, 2);
  for (int i = 0; i < kImages; ++i) {
    const double angle = 2 * 3.14159265358979 * (i % 50) / 50;
    descriptions.row(i) << static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle));
  }
  const auto pairs = ChoosePairs(descriptions);
  EXPECT_LE(static_cast<int64_t>(pairs.size()), PairsToMatch(kImages));
  const auto has = [&](int i, int j) { return std::find(pairs.begin(), pairs.end(), std::pair(i, j)) != pairs.end(); };
  for (int i = 0; i < 50; ++i) EXPECT_TRUE(has(i, i + 50)) << i;
  for (int i = 0; i + 4 < kImages; ++i) EXPECT_TRUE(has(i, i + 4)) << i;
  EXPECT_TRUE(has(0, 49)) << "the round closes";
  EXPECT_FALSE(has(0, 25)) << "the other side";
  EXPECT_TRUE(std::all_of(pairs.begin(), pairs.end(), [](const auto& pair) { return pair.first < pair.second; }));
}

TEST(ChoosePairs, MatchesImagesWithoutFeaturesInOrderOnly) {
  EXPECT_EQ(ChoosePairs(Eigen::MatrixXf::Zero(6, 4)).size(), 5u + 4 + 3 + 2);
}

}  // namespace
}  // namespace oraclegs
