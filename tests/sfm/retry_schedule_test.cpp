#include "oraclegs/sfm/retry_schedule.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

namespace oraclegs {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;

ModelQuality Sound(std::vector<std::string> names) {
  ModelQuality model;
  for (const std::string& name : names) model.images[name] = {};
  model.points = 100 * static_cast<int>(names.size());
  model.parallax_degrees = 5;
  return model;
}

ModelQuality SoundOf(int photographs) {
  std::vector<std::string> names;
  for (int i = 0; i < photographs; ++i) names.push_back(std::to_string(i));
  return Sound(names);
}

TEST(RegistrationLadder, BeginsStrictAndBecomesRelaxed) {
  const auto& ladder = RegistrationLadder();
  ASSERT_EQ(ladder.size(), 4u);
  EXPECT_THAT(ladder[0].extraction, IsEmpty()) << "colmap's own features";
  EXPECT_THAT(ladder[0].matching, IsEmpty());
  ASSERT_EQ(ladder[0].tries.size(), 4u);
  EXPECT_EQ(ladder[0].tries[0].name, "strict");
  EXPECT_EQ(ladder[0].tries[0].options.count("Mapper.init_min_tri_angle"), 0u);
  double angle = 16;  // colmap's own
  for (size_t i = 1; i < 3; ++i) {
    const double next = std::stod(ladder[0].tries[i].options.at("Mapper.init_min_tri_angle"));
    EXPECT_LT(next, angle);
    angle = next;
  }
  EXPECT_EQ(ladder[0].tries[2].options.at("Mapper.init_max_forward_motion"), "1");
  EXPECT_GT(ladder[0].tries[3].focal_guess, 0);
}

TEST(RegistrationLadder, NamesAreUniqueAndEveryModelOfTwoIsAllowed) {
  std::set<std::string> sets;
  int for_few = 1 << 30;
  for (const FeatureSet& set : RegistrationLadder()) {
    EXPECT_TRUE(sets.insert(set.name).second);
    EXPECT_LE(set.for_few, for_few) << "what costs more is for fewer photographs";
    for_few = set.for_few;
    std::set<std::string> tries;
    for (const MapperTry& attempt : set.tries) {
      EXPECT_TRUE(tries.insert(attempt.name).second);
      EXPECT_EQ(attempt.options.at("Mapper.min_model_size"), "2");
      EXPECT_EQ(attempt.options.at("Mapper.tri_ignore_two_view_tracks"), "0");
      EXPECT_EQ(attempt.options.count("Mapper.max_focal_length_ratio"), 1u);
    }
  }
  EXPECT_EQ(RegistrationLadder().back().extraction.count("SiftExtraction.domain_size_pooling"), 1u) << "slow: last";
}

TEST(IsEnough, OfFewAllOfManyHalf) {
  EXPECT_TRUE(IsEnough(SoundOf(3), 3));
  EXPECT_FALSE(IsEnough(SoundOf(2), 3));
  EXPECT_FALSE(IsEnough(SoundOf(23), 24));
  EXPECT_TRUE(IsEnough(SoundOf(20), 40));
  EXPECT_FALSE(IsEnough(SoundOf(19), 40));
  ModelQuality unsound = SoundOf(3);
  unsound.plausible_lenses = false;
  EXPECT_FALSE(IsEnough(unsound, 3));
}

TEST(IsWorthTrying, ExpensiveSetsAreForFewOrForDespair) {
  const auto& ladder = RegistrationLadder();
  EXPECT_FALSE(IsWorthTrying(ladder[1], SoundOf(3), 3)) << "all are registered";
  EXPECT_TRUE(IsWorthTrying(ladder[1], SoundOf(2), 3));
  EXPECT_TRUE(IsWorthTrying(ladder[3], SoundOf(2), 3));
  EXPECT_FALSE(IsWorthTrying(ladder[3], SoundOf(11), 12));
  EXPECT_TRUE(IsWorthTrying(ladder[3], SoundOf(5), 12)) << "fewer than half";
  EXPECT_FALSE(IsWorthTrying(ladder[1], SoundOf(20), 24));
  EXPECT_TRUE(IsWorthTrying(ladder[1], {}, 24));
  EXPECT_FALSE(IsWorthTrying(ladder[1], {}, 25)) << "hours";
}

TEST(CanMatchMissing, AsksForFeaturesInAPhotographThatIsMissing) {
  const ModelQuality best = Sound({"a", "b"});
  EXPECT_FALSE(CanMatchMissing({{"a", 5000}, {"b", 4000}, {"black", 0}}, best));
  EXPECT_TRUE(CanMatchMissing({{"a", 5000}, {"b", 4000}, {"dim", 200}}, best));
  EXPECT_TRUE(CanMatchMissing({{"a", 5000}, {"b", 4000}}, {})) << "nothing is registered yet";
  EXPECT_FALSE(CanMatchMissing({{"a", 3}, {"b", 0}}, {}));
}

TEST(PairsOfMissing, PairsWhatIsMissingWithEveryOther) {
  EXPECT_THAT(PairsOfMissing({"a", "b", "c", "d"}, Sound({"a", "c"})),
              ElementsAre(Pair("a", "b"), Pair("a", "d"), Pair("b", "c"), Pair("b", "d"), Pair("c", "d")));
  EXPECT_THAT(PairsOfMissing({"a", "b"}, Sound({"a", "b"})), IsEmpty());
  std::vector<std::string> many(200);
  for (size_t i = 0; i < many.size(); ++i) many[i] = std::to_string(i);
  EXPECT_THAT(PairsOfMissing(many, SoundOf(198)), IsEmpty()) << "397 pairs are too many";
}

}  // namespace
}  // namespace oraclegs
