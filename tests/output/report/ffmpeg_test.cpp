#include "oraclegs/output/report/ffmpeg.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

namespace oraclegs {
namespace {

TEST(RunFfmpeg, SaysNothingOfSuccess) { EXPECT_EQ(RunFfmpeg({.argv = {"sh", "-c", "echo hello >&2"}}), ""); }

TEST(RunFfmpeg, RepeatsTheLastWordsOfAFailure) {
  EXPECT_EQ(RunFfmpeg({.argv = {"sh", "-c", "echo first >&2; echo 'no\033[31m room' >&2; exit 3"}}),
            "ffmpeg failed (exit code 3): no?[31m room");
  EXPECT_EQ(RunFfmpeg({.argv = {"sh", "-c", "exit 3"}}), "ffmpeg failed (exit code 3)");
}

TEST(RunFfmpeg, EndsWhatDoesNothing) {
  setenv("ORACLEGS_STALL_LIMIT", "0.2", 1);
  EXPECT_EQ(RunFfmpeg({.argv = {"sh", "-c", "echo waiting >&2; sleep 60"}}),
            "ffmpeg did nothing for 0.2 s and was ended: waiting");
  unsetenv("ORACLEGS_STALL_LIMIT");
}

}  // namespace
}  // namespace oraclegs
