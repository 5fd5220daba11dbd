#include "oraclegs/experiments/launch/slurm_options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/errors.h"

namespace oraclegs {
namespace {

TEST(SlurmOptions, AskForNothingThatIsNotGiven) { EXPECT_THAT(SbatchArguments({}), testing::IsEmpty()); }

TEST(SlurmOptions, BecomeArguments) {
  SlurmOptions options;
  options.partition = "gpu", options.time = "1:00:00", options.cpus = 8, options.gpus = 1, options.memory = "32G";
  options.arguments = {"--account=a", "--exclusive"};
  EXPECT_THAT(SbatchArguments(options),
              testing::ElementsAre("--partition=gpu", "--time=1:00:00", "--cpus-per-task=8", "--gres=gpu:1",
                                   "--mem=32G", "--account=a", "--exclusive"));
}

TEST(SlurmOptions, HaveRanges) {
  SlurmOptions options;
  options.retries = -1;
  EXPECT_EQ(MessageOf<UsageError>([&] { CheckOptions(options); }), "--slurm-retries is -1, must be in 0 .. 100");
}

using testing::ElementsAre;
using testing::IsEmpty;

TEST(SlurmArrays, HoldAllThatWaitsWithoutALimit) {
  const SlurmArrays arrays = PlanSlurmArrays(2500, 7, 0);
  EXPECT_THAT(arrays.sizes, ElementsAre(1000, 1000, 500));
  EXPECT_EQ(arrays.throttle, 0u);
}

TEST(SlurmArrays, ShareTheLimit) {
  const SlurmArrays arrays = PlanSlurmArrays(1500, 0, 9);
  EXPECT_THAT(arrays.sizes, ElementsAre(1000, 500));
  EXPECT_EQ(arrays.throttle, 4u);
}

TEST(SlurmArrays, AreNoMoreThanTheLimit) {
  const SlurmArrays arrays = PlanSlurmArrays(3500, 0, 2);
  EXPECT_THAT(arrays.sizes, ElementsAre(1000, 1000)) << "a third would run one more";
  EXPECT_EQ(arrays.throttle, 1u);
}

TEST(SlurmArrays, WaitForRoom) {
  EXPECT_THAT(PlanSlurmArrays(10, 3, 4).sizes, ElementsAre(1));
  EXPECT_THAT(PlanSlurmArrays(10, 5, 4).sizes, IsEmpty());
  EXPECT_THAT(PlanSlurmArrays(0, 0, 4).sizes, IsEmpty());
}

}  // namespace

}  // namespace oraclegs
