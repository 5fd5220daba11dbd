#include "oraclegs/core/run_progress.h"

#include <gtest/gtest.h>

namespace oraclegs {
namespace {

using Clock = RunProgress::Clock;
using std::chrono::seconds;

const Clock::time_point kStart{};

RunProgress Planned() {
  RunProgress progress;
  progress.Add(RunPlanned{{{"sfm", 20}, {"depth", 40}, {"train", 100}}}, kStart);
  return progress;
}

TEST(RunProgress, KnowsNothingOfARunWithoutAPlan) {
  RunProgress progress;
  progress.Add(StageStarted{"sfm"}, kStart);
  EXPECT_FALSE(progress.PlaceOf("sfm"));
  EXPECT_EQ(progress.SecondsLeft(5, kStart), 0);
}

TEST(RunProgress, NumbersStages) {
  const RunProgress progress = Planned();
  const auto place = progress.PlaceOf("depth");
  ASSERT_TRUE(place);
  EXPECT_EQ(place->number, 2);
  EXPECT_EQ(place->of, 3);
  EXPECT_EQ(place->seconds, 40);
  EXPECT_FALSE(progress.PlaceOf("load"));
}

TEST(RunProgress, CountsDownWhileAStageMeasuresNothing) {
  RunProgress progress = Planned();
  EXPECT_EQ(progress.SecondsLeft(0, kStart), 160);
  progress.Add(StageStarted{"sfm"}, kStart);
  EXPECT_EQ(progress.SecondsLeft(0, kStart + seconds(5)), 155);
  EXPECT_EQ(progress.SecondsLeft(0, kStart + seconds(500)), 140);  // longer than planned: not below zero
}

TEST(RunProgress, TakesWhatTheStageMeasured) {
  RunProgress progress = Planned();
  progress.Add(StageStarted{"sfm"}, kStart);
  EXPECT_EQ(progress.SecondsLeft(7, kStart), 147);
}

TEST(RunProgress, ExpectsMoreAfterASlowStage) {
  RunProgress progress = Planned();
  progress.Add(StageStarted{"sfm"}, kStart);
  progress.Add(StageFinished{"sfm", 60}, kStart + seconds(60));
  // (20 + 60) / (20 + 20) = twice as slow, with twenty seconds that count as planned right.
  EXPECT_DOUBLE_EQ(progress.SecondsLeft(0, kStart + seconds(60)), 280);
}

TEST(RunProgress, DoesNotCountWhatWasKept) {
  RunProgress progress = Planned();
  progress.Add(StageKept{"sfm"}, kStart);
  progress.Add(StageKept{"depth"}, kStart);
  EXPECT_EQ(progress.SecondsLeft(0, kStart), 100);
}

TEST(RunProgress, SaysNothingWhereAStageIsUnknown) {
  RunProgress progress;
  progress.Add(RunPlanned{{{"sfm", 20}, {"train", 0}}}, kStart);
  progress.Add(StageStarted{"sfm"}, kStart);
  EXPECT_EQ(progress.SecondsLeft(3, kStart), 0);
  progress.Add(StageFinished{"sfm", 20}, kStart);
  progress.Add(StageStarted{"train"}, kStart);
  EXPECT_EQ(progress.SecondsLeft(12, kStart), 12);
}

}  // namespace
}  // namespace oraclegs
