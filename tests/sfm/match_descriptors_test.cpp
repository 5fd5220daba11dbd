#include "oraclegs/sfm/match_descriptors.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "oraclegs/core/parallel.h"
#include "oraclegs/core/rng.h"

namespace oraclegs {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// Unit vectors of the plane at these angles, in degrees.
Buffer<float> AtAngles(const std::vector<double>& degrees) {
  std::vector<float> values;
  for (const double angle : degrees) {
    values.push_back(static_cast<float>(std::cos(angle * M_PI / 180)));
    values.push_back(static_cast<float>(std::sin(angle * M_PI / 180)));
  }
  return Buffer<float>::From({static_cast<int64_t>(degrees.size()), 2}, std::span<const float>(values));
}

/// Random unit vectors of 16 numbers; with `noise` they are those of the first seed, a little changed.
Buffer<float> Random(int64_t count, double noise) {
  Rng rng(3, RandomStream::kInitialPoints), change(4, RandomStream::kInitialPoints);
  Buffer<float> rows = Buffer<float>::Empty({count, 16});
  for (int64_t i = 0; i < count; ++i) {
    Eigen::Map<Eigen::Matrix<float, 16, 1>> row(rows.data() + 16 * i);
    for (float& value : row) {
      value = static_cast<float>(rng.Uniform(-1, 1));
      value += static_cast<float>(change.Uniform(-noise, noise));
    }
    row.normalize();
  }
  return rows;
}

TEST(MatchDescriptors, ArePairsThatAreNearestToEachOther) {
  // 40 is nearest to 44, but 44 to 46; 170 has nobody near and nobody nearer.
  EXPECT_THAT(MatchDescriptors(AtAngles({0, 40, 46, 90}), AtAngles({91, 44.5, 1, 170}), 1),
              ElementsAre(FeatureMatch{0, 2}, FeatureMatch{2, 1}, FeatureMatch{3, 0}));
}

TEST(MatchDescriptors, WantsTheSecondNearestToBeFarther) {
  const Buffer<float> a = AtAngles({0}), b = AtAngles({10, -12, 90});
  EXPECT_THAT(MatchDescriptors(a, b, .9), ElementsAre(FeatureMatch{0, 0}));
  EXPECT_THAT(MatchDescriptors(a, b, .8), IsEmpty());
  EXPECT_THAT(MatchDescriptors(b, a, .8), IsEmpty());
  EXPECT_THAT(MatchDescriptors(a, AtAngles({10, 10, 90}), .9), IsEmpty()) << "two that are one";
}

TEST(MatchDescriptors, FindsWhatWasChangedALittle) {
  const Buffer<float> a = Random(700, 0), b = Random(700, .02);
  const std::vector<FeatureMatch> matches = MatchDescriptors(a, b);
  ASSERT_EQ(matches.size(), 700u);
  for (const FeatureMatch& match : matches) EXPECT_EQ(match.a, match.b);
}

TEST(MatchDescriptors, AreThoseOfTheSwappedImagesForAnyNumberOfThreads) {
  const Buffer<float> a = Random(500, .6), b = Random(300, .1);
  const int threads = NumThreads();
  SetNumThreads(1);
  const std::vector<FeatureMatch> matches = MatchDescriptors(a, b);
  SetNumThreads(3);
  EXPECT_EQ(MatchDescriptors(a, b), matches);
  SetNumThreads(threads);
  std::vector<FeatureMatch> swapped;
  for (const FeatureMatch& match : MatchDescriptors(b, a)) swapped.push_back({match.b, match.a});
  EXPECT_THAT(swapped, testing::UnorderedElementsAreArray(matches));
  EXPECT_GT(matches.size(), 50u);
  EXPECT_LT(matches.size(), 300u);
}

TEST(MatchDescriptors, AreNoneWithoutDescriptors) {
  EXPECT_THAT(MatchDescriptors(Buffer<float>::Empty({0, 2}), AtAngles({1, 2})), IsEmpty());
  EXPECT_THAT(MatchDescriptors(AtAngles({1, 2}), Buffer<float>::Empty({0, 2})), IsEmpty());
  EXPECT_THROW(MatchDescriptors(AtAngles({1}), Buffer<float>::Empty({3, 16})), ShapeError);
}

TEST(MatchDescriptors, WithNumbersThatAreNoneMatchNothing) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(MatchDescriptors(Buffer<float>::From({1, 2}, {nan, nan}), AtAngles({0, 90})), IsEmpty());
}

}  // namespace
}  // namespace oraclegs
