#include "oraclegs/core/run_progress.h"

#include <gtest/gtest.h>

namespace oraclegs {
namespace {

using std::chrono::seconds;

StepDone Done(int64_t done, int64_t total, const std::string& stage = "train") { return {stage, done, total, "", ""}; }

TEST(StepRate, MeasuresRateAndTimeLeft) {
  const StepRate::Clock::time_point start{};
  StepRate rate;
  EXPECT_EQ(rate.Add(Done(100, 1000), start).per_second, 0);
  const auto speed = rate.Add(Done(300, 1000), start + seconds(4));
  EXPECT_DOUBLE_EQ(speed.per_second, 50);
  EXPECT_DOUBLE_EQ(speed.seconds_left, 14);
}

TEST(StepRate, ForgetsWhatIsLongAgo) {
  const StepRate::Clock::time_point start{};
  StepRate rate;
  rate.Add(Done(0, 10000), start);
  rate.Add(Done(1000, 10000), start + seconds(10));
  rate.Add(Done(1100, 10000), start + seconds(35));
  EXPECT_DOUBLE_EQ(rate.Add(Done(1350, 10000), start + seconds(60)).per_second, 10);
}

TEST(StepRate, AnotherStageStartsAnew) {
  const StepRate::Clock::time_point start{};
  StepRate rate;
  rate.Add(Done(0, 10, "depth"), start);
  EXPECT_EQ(rate.Add(Done(500, 1000), start + seconds(1)).per_second, 0);
  EXPECT_EQ(rate.stage(), "train");
}

TEST(StepRate, WithoutATotalThereIsNoTimeLeft) {
  const StepRate::Clock::time_point start{};
  StepRate rate;
  rate.Add(Done(0, 0), start);
  const auto speed = rate.Add(Done(6, 0), start + seconds(3));
  EXPECT_DOUBLE_EQ(speed.per_second, 2);
  EXPECT_EQ(speed.seconds_left, 0);
}

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

TEST(RunProgress, LearnsNothingFromAStageThatDidNothingOrTriedAgain) {
  for (const int took : {1, 176}) {
    RunProgress progress = Planned();
    progress.Add(StageStarted{"sfm"}, kStart);
    progress.Add(StageFinished{"sfm", static_cast<double>(took)}, kStart + seconds(took));
    EXPECT_DOUBLE_EQ(progress.SecondsLeft(0, kStart + seconds(took)), 140) << took;
  }
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
