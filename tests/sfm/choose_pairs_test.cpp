#include "oraclegs/sfm/choose_pairs.h"
#include "oraclegs/core/rng.h"

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

/// `count` features of a place: each is one of 60 things that the place has, a little changed.
DescriptorMatrix Features(uint64_t place, uint64_t photo, int count) {
  DescriptorMatrix descriptors(count, 128);
  for (int i = 0; i < count; ++i) {
    const uint64_t thing = 1000 * place + static_cast<uint64_t>(i) % 60;
    for (uint64_t k = 0; k < 128; ++k) {
      const double shape = Philox::Draw(1, thing, k).Uniform(), noise = Philox::Draw(2, photo, i * 128 + k).Uniform();
      descriptors(i, static_cast<Eigen::Index>(k)) = static_cast<float>(200 * shape * shape + 40 * noise);
    }
  }
  return descriptors;
}

TEST(DescribeImages, IsAlikeForPhotosOfOnePlace) {
  std::vector<DescriptorMatrix> images;
  for (uint64_t place = 0; place < 4; ++place) {
    for (uint64_t photo = 0; photo < 3; ++photo) images.push_back(Features(place, 10 * place + photo, 300));
  }
  images.push_back(DescriptorMatrix(0, 128));
  const Eigen::MatrixXf descriptions = DescribeImages(images);
  const Eigen::MatrixXf alike = descriptions * descriptions.transpose();
  for (int i = 0; i < 12; ++i) {
    EXPECT_NEAR(alike(i, i), 1, 1e-4);
    for (int j = 0; j < 12; ++j) {
      EXPECT_EQ(alike(i, j) > .5F, i / 3 == j / 3) << i << " " << j << " " << alike(i, j);
    }
  }
  EXPECT_EQ(alike(12, 12), 0) << "no features";
  EXPECT_EQ(descriptions, DescribeImages(images));
}

TEST(DescribeImages, HoldsWithoutFeatures) {
  EXPECT_EQ(DescribeImages({DescriptorMatrix(0, 128), DescriptorMatrix(0, 128)}).rows(), 2);
}

}  // namespace

}  // namespace oraclegs
