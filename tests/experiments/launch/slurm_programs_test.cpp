#include "oraclegs/experiments/launch/slurm_programs.h"

#include <gtest/gtest.h>

namespace oraclegs {
namespace {

TEST(SlurmPrograms, ReadsTheQueue) {
  const SlurmTaskStates states = ParseSqueue(
      "12|0|RUNNING|None\n12|1|PENDING|PartitionTimeLimit\n12|2|OUT_OF_MEMORY|OutOfMemory\n9|N/A|RUNNING|None\n"
      "slurm_load_jobs: a warning\n");
  ASSERT_EQ(states.size(), 3U);
  EXPECT_EQ(states.at({"12", 0}).state, SlurmState::kActive);
  EXPECT_EQ(states.at({"12", 0}).reason, "");
  EXPECT_EQ(states.at({"12", 1}).reason, "PartitionTimeLimit");
  EXPECT_EQ(states.at({"12", 2}).state, SlurmState::kOutOfMemory);
}

TEST(SlurmPrograms, ReadsTheAccounts) {
  const SlurmTaskStates states = ParseSacct(
      "12_0|COMPLETED|0:0||61\n12_0.batch|COMPLETED|0:0|1.5G|61\n12_0.extern|COMPLETED|0:0|100K|61\n"
      "12_1|CANCELLED by 1000|0:15||7\n12_[2-9%4]|PENDING|0:0||0\n77|COMPLETED|0:0||1\n12_3|FAILED|3:0||2\n");
  ASSERT_EQ(states.size(), 3U);
  EXPECT_EQ(states.at({"12", 0}).peak_bytes, int64_t{3} << 29);
  EXPECT_EQ(states.at({"12", 0}).seconds, 61);
  EXPECT_EQ(states.at({"12", 1}).state, SlurmState::kCancelled);
  EXPECT_EQ(states.at({"12", 1}).exit_code, 143);
  EXPECT_EQ(states.at({"12", 3}).exit_code, 3);
}

TEST(SlurmPrograms, ReadsTheNumberOfAnArrayAmongOtherLines) {
  const auto array = ParseSbatch("sbatch: Checking quotas\n4711;alps\n");
  ASSERT_TRUE(array);
  EXPECT_EQ(array->id, "4711");
  EXPECT_EQ(array->cluster, "alps");
  EXPECT_EQ(ParseSbatch("4711\n")->cluster, "");
  EXPECT_FALSE(ParseSbatch("Submitted nothing\n\n"));
}

TEST(SlurmPrograms, KnowsTheStatesThatEnd) {
  EXPECT_EQ(SlurmStateOf("NODE_FAIL"), SlurmState::kNodeFailed);
  EXPECT_EQ(SlurmStateOf("CANCELLED+"), SlurmState::kCancelled);
  EXPECT_EQ(SlurmStateOf("DEADLINE"), SlurmState::kTimeLimit);
  for (const char* word : {"PENDING", "COMPLETING", "CONFIGURING", "SUSPENDED", "REQUEUED", "A_NEW_ONE"}) {
    EXPECT_EQ(SlurmStateOf(word), SlurmState::kActive) << word;
  }
}

}  // namespace
}  // namespace oraclegs
