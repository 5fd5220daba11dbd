#include "oraclegs/core/step_rate.h"

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

}  // namespace
}  // namespace oraclegs
