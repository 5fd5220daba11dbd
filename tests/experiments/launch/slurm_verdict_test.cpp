#include "oraclegs/experiments/launch/slurm_verdict.h"

#include <gtest/gtest.h>

namespace oraclegs {
namespace {

SlurmTaskState In(SlurmState state) { return {.state = state, .reason = {}, .exit_code = {}}; }

TEST(SlurmVerdict, ADoneFileIsEnoughWhenSlurmIsSlow) {
  SlurmEvidence evidence{.queue = In(SlurmState::kActive), .accounts = {}, .file = SlurmTaskEnd{0, 12, 4096}};
  EXPECT_FALSE(SlurmVerdict(evidence, "log")) << "the accounts may have the memory";
  evidence.looks = kSlurmFileLooks;
  const auto result = SlurmVerdict(evidence, "log");
  ASSERT_TRUE(result);
  EXPECT_EQ(result->end, JobEnd::kDone);
  EXPECT_EQ(result->seconds, 12);
  EXPECT_EQ(result->peak_bytes, 4096);
}

TEST(SlurmVerdict, AFailureWaitsForSlurmsOwnWord) {
  EXPECT_FALSE(SlurmVerdict({.queue = In(SlurmState::kActive), .accounts = {}, .file = SlurmTaskEnd{137, 1}}, "log"));
  EXPECT_EQ(
      SlurmVerdict({.queue = In(SlurmState::kTimeLimit), .accounts = {}, .file = SlurmTaskEnd{143, 1}}, "log")->end,
      JobEnd::kOutOfTime);
}

TEST(SlurmVerdict, WaitsForAFileOnASlowFileSystem) {
  SlurmEvidence evidence{.queue = In(SlurmState::kFailed), .accounts = {}, .file = {}};
  EXPECT_FALSE(SlurmVerdict(evidence, "log"));
  evidence.looks = kSlurmFileLooks;
  EXPECT_EQ(SlurmVerdict(evidence, "log")->end, JobEnd::kFailed);
  evidence.queue = In(SlurmState::kCompleted);
  EXPECT_EQ(SlurmVerdict(evidence, "log")->end, JobEnd::kDone);
}

TEST(SlurmVerdict, WhatNobodyKnowsAnyMoreWasCancelled) {
  EXPECT_FALSE(SlurmVerdict({}, "log"));
  EXPECT_EQ(SlurmVerdict({.queue = {}, .accounts = {}, .file = {}, .looks = kSlurmFileLooks}, "log")->end,
            JobEnd::kCancelled);
  EXPECT_EQ(SlurmVerdict({.queue = {}, .accounts = {}, .file = SlurmTaskEnd{130, 1, 0, true}}, "log")->end,
            JobEnd::kCancelled);
  EXPECT_EQ(SlurmVerdict({.queue = {}, .accounts = {}, .file = SlurmTaskEnd{4, 1, 0, false}}, "log")->end,
            JobEnd::kFailed);
}

TEST(SlurmVerdict, TheAccountsRememberLongerThanTheQueue) {
  SlurmTaskState accounts = In(SlurmState::kNodeFailed);
  EXPECT_EQ(SlurmVerdict({.queue = {}, .accounts = accounts, .file = {}}, "log")->why, "its machine failed");
  accounts = In(SlurmState::kFailed);
  accounts.exit_code = 3, accounts.peak_bytes = 7, accounts.seconds = 5;
  const auto result = SlurmVerdict({.queue = {}, .accounts = accounts, .file = {}, .looks = kSlurmFileLooks}, "log");
  EXPECT_EQ(result->exit_code, 3);
  EXPECT_EQ(result->peak_bytes, 7);
  EXPECT_EQ(result->seconds, 5);
}

TEST(SlurmVerdict, TriesAgainWhatMayEndOtherwise) {
  const auto worth = [](JobEnd end, int code) { return IsWorthAnotherTry({.end = end, .exit_code = code, .why = {}}); };
  EXPECT_TRUE(worth(JobEnd::kCancelled, 143));
  EXPECT_TRUE(worth(JobEnd::kFailed, 4));
  EXPECT_FALSE(worth(JobEnd::kFailed, 2));
  EXPECT_FALSE(worth(JobEnd::kFailed, 3));
  EXPECT_FALSE(worth(JobEnd::kFailed, 127));
  EXPECT_FALSE(worth(JobEnd::kOutOfMemory, 137));
  EXPECT_FALSE(worth(JobEnd::kOutOfTime, 143));
}

}  // namespace
}  // namespace oraclegs
