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

}  // namespace
}  // namespace oraclegs
