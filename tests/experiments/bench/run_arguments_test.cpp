#include "oraclegs/experiments/bench/run_arguments.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "support/errors.h"

namespace oraclegs {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;

TEST(RunArguments, OverlayReplacesInPlaceAndAppends) {
  EXPECT_THAT(Overlaid({{"views", "12"}, {"init", "sfm"}}, {{"init", "random"}, {"seed", "3"}}),
              ElementsAre(Pair("views", "12"), Pair("init", "random"), Pair("seed", "3")));
}

TEST(RunArguments, WordsOfFlagsHaveNoValue) {
  EXPECT_THAT(ArgumentWords({{"views", "12"}, {"eval", ""}, {"init-planes", "false"}, {"report", "true"}}),
              ElementsAre("--views", "12", "--eval", "--set", "init-planes=false", "--report"));
}

TEST(RunArguments, OptionsHaveTheValues) {
  const RunOptions options = OptionsOf({{"views", "12"}, {"eval", ""}, {"init-planes", "false"}});
  EXPECT_EQ(options.split.views, 12);
  EXPECT_TRUE(options.split.eval);
  EXPECT_FALSE(options.start.init_planes);
  EXPECT_THAT(MessageOf<UsageError>([] { OptionsOf({{"magic", "1"}}); }), HasSubstr("--magic"));
  EXPECT_THAT(MessageOf<UsageError>([] { OptionsOf({{"views", "-1"}}); }), HasSubstr("--views"));
}

TEST(ResultArguments, LeavesOutWhatChangesNoResult) {
  EXPECT_EQ(ResultArguments({{"views", "12"}, {"threads", "2"}, {"device", "cuda"}, {"report", "false"}, {"eval", ""}}),
            json({{"views", "12"}, {"eval", "true"}}));
}

TEST(DifferenceOf, NamesWhatChanged) {
  EXPECT_EQ(DifferenceOf({{"views", "12"}}, {{"views", "12"}}), "");
  EXPECT_EQ(DifferenceOf({{"views", "12"}, {"init", "sfm"}}, {{"views", "9"}, {"seed", "1"}}),
            "--init was sfm, now is not given; --seed was not given, now is 1; --views was 12, now is 9");
}

}  // namespace
}  // namespace oraclegs
