#include "oraclegs/experiments/bench/published.h"

#include <gmock/gmock.h>

#include <set>

namespace oraclegs {
namespace {

using testing::HasSubstr;

TEST(PublishedFor, HasEachMethodOnceWithItsSource) {
  for (const auto& [suite, views, count] :
       {std::tuple{"mipnerf360", 12, 7u}, {"mipnerf360", 24, 7u}, {"blender", 8, 2u}}) {
    std::set<std::string> methods;
    for (const PublishedScore& score : PublishedFor(suite, views)) {
      methods.insert(score.method);
      EXPECT_THAT(score.source, HasSubstr("[Topaloglu 2026]"));
      ASSERT_TRUE(score.psnr);
      EXPECT_TRUE(*score.psnr > 18 && *score.psnr < 26) << score.label;
      EXPECT_EQ(score.ssim.has_value(), score.lpips.has_value());
    }
    EXPECT_EQ(methods.size(), count) << suite << views;
  }
}

TEST(PublishedFor, HasNoneOfOtherProtocols) {
  EXPECT_TRUE(PublishedFor("mipnerf360", 6).empty());
  EXPECT_TRUE(PublishedFor("llff", 3).empty());
}

}  // namespace
}  // namespace oraclegs
