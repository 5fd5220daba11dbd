#include "oraclegs/sfm/retry_schedule.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "oraclegs/sfm/choose_pairs.h"

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

ModelQuality SoundOf(int images) {
  std::vector<std::string> names;
  for (int i = 0; i < images; ++i) names.push_back(std::to_string(i));
  return Sound(names);
}

TEST(RegistrationSchedule, BeginsStrict) {
  const auto& schedule = RegistrationSchedule(12);
  ASSERT_EQ(schedule.size(), 6u);
  EXPECT_THAT(schedule[0].extraction, IsEmpty()) << "colmap's own features";
  EXPECT_THAT(schedule[0].matching, IsEmpty());
  ASSERT_EQ(schedule[0].attempts.size(), 4u);
  EXPECT_EQ(schedule[0].attempts[0].name, "strict");
  EXPECT_EQ(schedule[0].attempts[0].options.count("Mapper.init_min_tri_angle"), 0u);
  double angle = 16;  // colmap's own
  for (size_t i = 1; i < 3; ++i) {
    const double next = std::stod(schedule[0].attempts[i].options.at("Mapper.init_min_tri_angle"));
    EXPECT_LT(next, angle);
    angle = next;
  }
  EXPECT_EQ(schedule[0].attempts[2].options.at("Mapper.init_max_forward_motion"), "1");
  EXPECT_GT(schedule[0].attempts[3].focal_guess, 0);
}

TEST(RegistrationSchedule, HasUniqueNames) {
  std::set<std::string> sets;
  int max_images = 1 << 30;
  for (const FeatureSet& set : RegistrationSchedule(12)) {
    EXPECT_TRUE(sets.insert(set.name).second);
    EXPECT_LE(set.max_images, max_images) << "what costs more is for fewer images";
    max_images = set.max_images;
    std::set<std::string> attempts;
    for (const MapperAttempt& attempt : set.attempts) {
      EXPECT_TRUE(attempts.insert(attempt.name).second);
      EXPECT_EQ(attempt.options.at("Mapper.min_model_size"), "2");
      EXPECT_EQ(attempt.options.at("Mapper.tri_ignore_two_view_tracks"), "0");
      EXPECT_EQ(attempt.options.count("Mapper.max_focal_length_ratio"), 1u);
    }
  }
  EXPECT_EQ(RegistrationSchedule(12).back().extraction.count("SiftExtraction.domain_size_pooling"), 1u) << "slow: last";
}

TEST(RegistrationSchedule, FindsFewFeaturesInManyPhotos) {
  const auto& schedule = RegistrationSchedule(kMaxImagesToMatchAll + 1);
  ASSERT_EQ(schedule.size(), 2u);
  EXPECT_EQ(schedule[0].extraction.count("SiftExtraction.max_num_features"), 1u);
  EXPECT_THAT(schedule[1].extraction, IsEmpty()) << "where these do not suffice";
  for (const FeatureSet& set : schedule) {
    EXPECT_EQ(set.attempts[0].options.at("Mapper.min_model_size"), "2");
    EXPECT_TRUE(IsWorthTrying(set, SoundOf(100), 300, {9, false, 9}));
    EXPECT_FALSE(IsWorthTrying(set, SoundOf(280), 300, {9, false, 9}));
  }
}

TEST(IsEnough, RequiresAllOfFewAndHalfOfMany) {
  EXPECT_TRUE(IsEnough(SoundOf(3), 3));
  EXPECT_FALSE(IsEnough(SoundOf(2), 3));
  EXPECT_FALSE(IsEnough(SoundOf(23), 24));
  EXPECT_TRUE(IsEnough(SoundOf(20), 40));
  EXPECT_FALSE(IsEnough(SoundOf(19), 40));
  EXPECT_TRUE(IsEnough(SoundOf(90), 100));
  EXPECT_FALSE(IsEnough(SoundOf(89), 100));
  ModelQuality unsound = SoundOf(3);
  unsound.plausible_intrinsics = false;
  EXPECT_FALSE(IsEnough(unsound, 3));
}

TEST(IsWorthTrying, SavesExpensiveSetsForFewImages) {
  const auto& schedule = RegistrationSchedule(12);
  const MatchEvidence linked{3, false, 3};
  for (size_t i = 1; i < schedule.size(); ++i) {
    EXPECT_FALSE(IsWorthTrying(schedule[i], SoundOf(3), 3, linked)) << "all are registered";
    EXPECT_TRUE(IsWorthTrying(schedule[i], SoundOf(2), 3, linked)) << i;
    EXPECT_FALSE(IsWorthTrying(schedule[i], {}, 25, linked)) << "hours";
  }
  EXPECT_TRUE(IsWorthTrying(schedule[1], {}, 24, linked)) << "learned features";
  EXPECT_TRUE(IsWorthTrying(schedule[2], {}, 24, linked)) << "coarse features";
  EXPECT_FALSE(IsWorthTrying(schedule[3], {}, 24, linked)) << "a quarter of an hour";
  EXPECT_FALSE(IsWorthTrying(schedule[5], SoundOf(11), 12, linked));
}

TEST(IsWorthTrying, AsksTheMatches) {
  const auto& schedule = RegistrationSchedule(12);
  EXPECT_TRUE(IsWorthTrying(schedule[1], SoundOf(2), 3, {0, false})) << "learned features may link what is missing";
  EXPECT_TRUE(IsWorthTrying(schedule[2], SoundOf(2), 3, {0, false})) << "coarse features may, too";
  EXPECT_FALSE(IsWorthTrying(schedule[3], SoundOf(2), 3, {0, false})) << "nothing does";
  EXPECT_FALSE(IsWorthTrying(schedule[1], {}, 3, {3, true})) << "no features give parallax";
}

TEST(IsWorthTrying, StopsWherePhotosAreLinkedInPairsAlone) {
  const FeatureSet& costly = RegistrationSchedule(12)[3];
  const ImageLinks pairs{{"0", "1"}, {"2", "3"}, {"4", "5"}};
  for (const ModelQuality& best : {ModelQuality(), SoundOf(2)}) {
    const MatchEvidence evidence = EvidenceOf(pairs, best, false);
    EXPECT_EQ(evidence.group, 2);
    EXPECT_EQ(evidence.links, best.registered() == 0 ? 3 : 2);
    EXPECT_FALSE(IsWorthTrying(costly, best, 12, evidence));
  }
  ImageLinks chain = pairs;
  chain.insert({"1", "2"});
  EXPECT_EQ(EvidenceOf(chain, SoundOf(2), false).group, 4);
  EXPECT_TRUE(IsWorthTrying(costly, SoundOf(2), 12, EvidenceOf(chain, SoundOf(2), false)));
  EXPECT_TRUE(IsWorthTrying(costly, {}, 3, EvidenceOf({{"0", "1"}}, {}, false))) << "of three every link counts";
  EXPECT_FALSE(IsWorthTrying(costly, SoundOf(2), 12, EvidenceOf({{"0", "1"}}, SoundOf(2), false)));
}

TEST(CanMatchMissing, RequiresFeaturesInAMissingImage) {
  const ModelQuality best = Sound({"a", "b"});
  EXPECT_FALSE(CanMatchMissing({{"a", 5000}, {"b", 4000}, {"black", 0}}, best));
  EXPECT_TRUE(CanMatchMissing({{"a", 5000}, {"b", 4000}, {"dim", 200}}, best));
  EXPECT_TRUE(CanMatchMissing({{"a", 5000}, {"b", 4000}}, {})) << "nothing is registered yet";
  EXPECT_FALSE(CanMatchMissing({{"a", 3}, {"b", 0}}, {}));
}

TEST(PairsOfMissing, PairsMissingImagesWithEveryOther) {
  EXPECT_THAT(PairsOfMissing({"a", "b", "c", "d"}, Sound({"a", "c"})),
              ElementsAre(Pair("a", "b"), Pair("a", "d"), Pair("b", "c"), Pair("b", "d"), Pair("c", "d")));
  EXPECT_THAT(PairsOfMissing({"a", "b"}, Sound({"a", "b"})), IsEmpty());
  std::vector<std::string> many(200);
  for (size_t i = 0; i < many.size(); ++i) many[i] = std::to_string(i);
  EXPECT_THAT(PairsOfMissing(many, SoundOf(198)), IsEmpty()) << "397 pairs are too many";
}

}  // namespace
}  // namespace oraclegs
