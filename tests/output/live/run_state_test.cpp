#include "oraclegs/output/live/run_state.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace oraclegs {
namespace {

TEST(RunState, FoldsTheEventsOfStages) {
  RunState state;
  state.Add(StageStarted{"sfm"});
  state.Add(StageFinished{"sfm", 2.5});
  state.Add(StageStarted{"depth"});
  state.Add(StageFinished{"depth", 0.1});
  state.Add(StageKept{"depth"});
  state.Add(StageStarted{"train"});
  state.Add(StepDone{"load", 1, 2, "views", ""});
  state.Add(StepDone{"train", 30, 100, "iterations", "loss 0.1"});
  state.Add(Warning{"look out"});
  const nlohmann::json json = state.ToJson();
  EXPECT_EQ(json.at("state"), "running");
  EXPECT_EQ(json.at("warnings"), nlohmann::json({"look out"}));
  const nlohmann::json& stages = json.at("stages");
  ASSERT_EQ(stages.size(), 3u);
  EXPECT_EQ(stages[0].at("state"), "done");
  EXPECT_EQ(stages[0].at("seconds"), 2.5);
  EXPECT_EQ(stages[1].at("state"), "unchanged");
  EXPECT_EQ(stages[2].at("state"), "running");
  EXPECT_EQ(stages[2].at("done"), 30);
  EXPECT_EQ(stages[2].at("total"), 100);
  EXPECT_EQ(stages[2].at("unit"), "iterations");
  EXPECT_EQ(stages[2].at("detail"), "loss 0.1");
  EXPECT_TRUE(stages[2].at("eta_seconds").is_null()) << "one report is no rate";
}

TEST(RunState, EndsOnce) {
  RunState state;
  state.Add(StageStarted{"train"});
  EXPECT_FALSE(state.ended());
  state.SetEnd(RunEnd::kFailed, "disk full");
  EXPECT_TRUE(state.ended());
  EXPECT_EQ(state.ToJson().at("state"), "failed");
  EXPECT_EQ(state.ToJson().at("message"), "disk full");
}

TEST(RunState, KeepsAHundredWarnings) {
  RunState state;
  for (int i = 0; i < 1000; ++i) state.Add(Warning{"again"});
  EXPECT_EQ(state.ToJson().at("warnings").size(), 100u);
}

TEST(RunState, TimesAreUtc) { EXPECT_THAT(UtcNow(), testing::MatchesRegex("20..-..-..T..:..:..Z")); }

}  // namespace
}  // namespace oraclegs
