#include "oraclegs/sfm/colmap_option_names.h"

#include <gtest/gtest.h>

namespace oraclegs {
namespace {

TEST(RefusedNames, GivesTheNewNameOnceTheOldOneWasRefused) {
  RefusedNames names;
  EXPECT_EQ(names.NameFor("colmap", "SiftMatching.use_gpu"), "SiftMatching.use_gpu");
  const std::string refusal = "Failed to parse options - unknown option '--SiftMatching.use_gpu'.";
  EXPECT_TRUE(names.Learn("colmap", refusal));
  EXPECT_EQ(names.NameFor("colmap", "SiftMatching.use_gpu"), "FeatureMatching.use_gpu");
  EXPECT_EQ(names.NameFor("colmap", "SiftMatching.num_threads"), "SiftMatching.num_threads") << "it may be known";
  EXPECT_EQ(names.NameFor("other/colmap", "SiftMatching.use_gpu"), "SiftMatching.use_gpu");
  EXPECT_FALSE(names.Learn("colmap", refusal)) << "asking again would not end";
}

TEST(RefusedNames, LearnsNothingFromOtherFailures) {
  RefusedNames names;
  EXPECT_FALSE(names.Learn("colmap", "no good initial image pair found"));
  EXPECT_FALSE(names.Learn("colmap", "unknown option '--SiftMatching.unheard_of'"));
  EXPECT_FALSE(names.Learn("colmap", "unknown option '--"));
  EXPECT_EQ(names.NameFor("colmap", "SiftMatching.unheard_of"), "SiftMatching.unheard_of");
}

}  // namespace
}  // namespace oraclegs
