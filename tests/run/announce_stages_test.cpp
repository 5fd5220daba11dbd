#include "oraclegs/run/stages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "oraclegs/run/start.h"
#include "run/fixtures.h"

namespace oraclegs {
namespace {

class AnnounceStagesTest : public testing::Test {
 protected:
  /// The plan that a run announces, and no event but this.
  std::vector<RunPlanned> Plans(bool estimates) {
    std::vector<RunPlanned> plans;
    RunRequest request = TinyRequest(MakeTinyScene(temp / "scene"), temp / "out");
    request.estimates = estimates;
    StartRun(request, [&](const Event& event) {
      if (const auto* plan = std::get_if<RunPlanned>(&event)) plans.push_back(*plan);
    });
    return plans;
  }

  TempDir temp;
};

TEST_F(AnnounceStagesTest, NamesTheStagesOfThisRunWithTimes) {
  const auto plans = Plans(true);
  ASSERT_EQ(plans.size(), 1u);
  std::vector<std::string> names;
  for (const auto& [stage, seconds] : plans[0].stages) {
    names.push_back(stage);
    EXPECT_GT(seconds, 0) << stage;
  }
  EXPECT_THAT(names, testing::Contains("train"));
  EXPECT_THAT(names, testing::Not(testing::Contains("register"))) << "the scene has poses";
  EXPECT_THAT(names, testing::Not(testing::Contains("proxies"))) << "nothing is proposed";
}

TEST_F(AnnounceStagesTest, IsSilentUnlessAsked) { EXPECT_TRUE(Plans(false).empty()); }

}  // namespace
}  // namespace oraclegs
