#include "oraclegs/core/subprocess.h"

#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <thread>
#include <utility>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/interrupt.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

ProcessResult Shell(const std::string& script) { return RunProcess({"sh", "-c", script}); }

TEST(Subprocess, GathersBothStreamsAndTheExitCode) {
  const auto result = Shell("echo out; echo err >&2; exit 7");
  EXPECT_EQ(result.exit_code, 7);
  EXPECT_THAT(result.output, AllOf(HasSubstr("out\n"), HasSubstr("err\n")));
}

TEST(Subprocess, NoShellTouchesTheArguments) {
  const auto result = RunProcess({"printf", "%s|", "a b", "$HOME", "*", ";false", ""});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.output, "a b|$HOME|*|;false||");
}

TEST(Subprocess, ProgramThatDoesNotExist) {
  const auto result = RunProcess({"oraclegs-no-such-program"});
  EXPECT_EQ(result.exit_code, 127);
  EXPECT_EQ(result.output, "cannot start oraclegs-no-such-program: No such file or directory\n");
  EXPECT_THROW(RunProcess(ProcessRequest{}), std::logic_error);
}

TEST(Subprocess, DeathBySignalIsTold) { EXPECT_EQ(Shell("kill -9 $$").exit_code, 128 + 9); }

TEST(Subprocess, StdinIsEmpty) {
  const auto result = RunProcess({"cat"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.output, "");
}

TEST(Subprocess, FeedsStdin) {
  const std::string piece(300000, 'x');  // more than a socket holds
  int pieces = 0;
  const auto result =
      RunProcess({.argv = {"sh", "-c", "wc -c; cat"}, .next_input = [&] { return pieces++ < 5 ? piece : ""; }});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.output, "1500000\n");
  EXPECT_EQ(pieces, 6);
}

TEST(Subprocess, DropsInputThatNobodyReads) {
  int pieces = 0;
  const auto result = RunProcess({.argv = {"sh", "-c", "exec <&-; sleep 0.1; exit 3"}, .next_input = [&] {
                                    ++pieces;
                                    return std::string(100000, 'x');
                                  }});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_LT(pieces, 50);
  EXPECT_THROW(RunProcess({.argv = {"cat"}, .next_input = []() -> std::string { throw InputError("stop"); }}),
               InputError);
}

TEST(Subprocess, LinesArriveWhole) {
  std::vector<std::string> lines;
  RunProcess({"printf", "one\\r\\n\\ntwo\\nthree"}, {}, [&](const std::string& line) { lines.push_back(line); });
  EXPECT_THAT(lines, ElementsAre("one", "", "two", "three"));
}

TEST(Subprocess, LogIsAppendedTo) {
  const TempDir dir;
  const auto log = dir / "log.txt";
  RunProcess({"echo", "first"}, log);
  RunProcess({"echo", "second"}, log);
  EXPECT_EQ(ReadFile(log), "first\nsecond\n");
  EXPECT_THAT([&] { RunProcess({"true"}, dir / "none/log.txt"); },
              ThrowsMessage<RunError>(HasSubstr("none/log.txt: cannot write")));
}

TEST(Subprocess, OnlyTheTailOfMuchOutputIsKept) {
  const auto result = Shell("seq 1 100000; echo the end");
  EXPECT_EQ(result.output.size(), 64u * 1024);
  EXPECT_THAT(result.output, testing::EndsWith("100000\nthe end\n"));
}

TEST(Subprocess, AGrandchildThatLeavesTheGroupDoesNotHoldUsUp) {
  const TempDir dir;
  const auto result = Shell("setsid sleep 60 & echo $! > " + (dir / "pid").string() + "; sleep 0.2; echo done");
  EXPECT_EQ(result.output, "done\n");
  const int grandchild = std::stoi(ReadFile(dir / "pid"));
  EXPECT_EQ(kill(grandchild, 0), 0) << "it was waited for";
  kill(grandchild, SIGKILL);
}

TEST(Subprocess, AStalledProgramIsEnded) {
  const auto stalls = [](const std::string& script) {
    return RunProcess({.argv = {"sh", "-c", script}, .stall_limit = std::chrono::duration<double>(0.5)});
  };
  const auto waits = stalls("echo first; sleep 60");
  EXPECT_TRUE(waits.stalled);
  EXPECT_FALSE(waits.timed_out);
  EXPECT_EQ(waits.output, "first\n");
  EXPECT_EQ(waits.exit_code, 128 + SIGTERM);
  EXPECT_FALSE(stalls("for i in 1 2 3 4 5 6; do sleep 0.2; echo $i; done").stalled) << "it prints";
  EXPECT_FALSE(stalls("i=0; while [ $i -lt 4000000 ]; do i=$((i + 1)); done").stalled) << "it computes";
}

TEST(Subprocess, ATimeInWhichThisProcessWasPausedIsNoStall) {
  ProcessRequest request{{"sleep", "2.4"}};
  request.stall_limit = std::chrono::duration<double>(1);
  bool paused = false;
  request.while_running = [&] {
    if (!std::exchange(paused, true)) std::this_thread::sleep_for(std::chrono::milliseconds(2000));
  };
  EXPECT_FALSE(RunProcess(request).stalled);
}

TEST(Subprocess, TheStallLimitCanBeSet) {
  EXPECT_EQ(StallLimit().count(), 120);
  for (const char* text : {"0", "-1", "never", "nan", ""}) {
    setenv("ORACLEGS_STALL_LIMIT", text, 1);
    EXPECT_EQ(StallLimit().count(), 120) << text;
  }
  setenv("ORACLEGS_STALL_LIMIT", "2.5", 1);
  EXPECT_EQ(StallLimit().count(), 2.5);
  unsetenv("ORACLEGS_STALL_LIMIT");
}

TEST(Subprocess, AThrowingListenerEndsTheChild) {
  int child = 0;
  const auto throws = [&](const std::string& line) {
    child = std::stoi(line);
    throw RunError("enough");
  };
  EXPECT_THROW(RunProcess({"sh", "-c", "echo $$; exec sleep 60"}, {}, throws), RunError);
  ASSERT_GT(child, 0);
  EXPECT_EQ(kill(child, 0), -1) << "it lives on";
}

TEST(Subprocess, InterruptEndsTheChildAndItsChildren) {
  std::string pid;
  const auto interrupt = [&](const std::string& line) {
    pid = line;
    RequestInterrupt(true);
  };
  EXPECT_THROW(RunProcess({"sh", "-c", "sleep 60 & echo $!; wait"}, {}, interrupt), Interrupted);
  RequestInterrupt(false);
  const std::string stat = "/proc/" + pid + "/stat";  // gone, or a zombie nobody has waited for
  const auto is_running = [&] {
    return std::filesystem::exists(stat) &&
           testing::Value(RunProcess({"cat", stat}).output,
                          testing::Not(testing::AnyOf(HasSubstr(") Z "), HasSubstr("No such file"))));
  };
  for (int i = 0; i < 500 && is_running(); ++i) usleep(10'000);  // the signal is on its way
  EXPECT_FALSE(is_running());
}

TEST(Subprocess, AnInterruptAlsoEndsAGrandchildThatIgnoresTheFirstSignal) {
  std::string pid;
  const auto interrupt = [&](const std::string& line) {
    pid = line;
    RequestInterrupt(true);
  };
  const char* script = "sh -c 'trap \"\" TERM; echo $$; while true; do sleep 0.1; done' & wait";
  EXPECT_THROW(RunProcess({"sh", "-c", script}, {}, interrupt), Interrupted);
  RequestInterrupt(false);
  const std::string stat = "/proc/" + pid + "/stat";
  for (int i = 0; i < 100 && std::filesystem::exists(stat); ++i) {  // SIGKILL is on its way
    if (RunProcess({"cat", stat}).output.find(") Z ") != std::string::npos) return;
    usleep(10'000);
  }
  EXPECT_FALSE(std::filesystem::exists(stat));
}

TEST(Subprocess, TimeLimitEndsTheChild) {
  const auto result = RunProcess(
      ProcessRequest{.argv = {"sh", "-c", "echo begun; exec sleep 60"}, .time_limit = std::chrono::milliseconds(200)});
  EXPECT_TRUE(result.timed_out);
  EXPECT_EQ(result.output, "begun\n");
  EXPECT_EQ(result.exit_code, 128 + SIGTERM);
  EXPECT_FALSE(RunProcess(ProcessRequest{.argv = {"true"}, .time_limit = std::chrono::seconds(60)}).timed_out);
}

TEST(Subprocess, LastLineOfStderrIsKeptApart) {
  const auto last_error = [](const std::string& script) {
    return RunProcess(ProcessRequest{.argv = {"sh", "-c", script}, .errors_apart = true}).last_error;
  };
  EXPECT_EQ(last_error("echo first >&2; echo why >&2; echo ' ' >&2; echo out"), "why");
  EXPECT_EQ(last_error("echo out"), "");
  EXPECT_EQ(last_error("printf 'no newline' >&2"), "no newline");
}

TEST(Subprocess, StreamsKeepTheirOrder) {
  for (int i = 0; i < 20; ++i) EXPECT_EQ(Shell("echo a; echo b >&2; echo c; echo d >&2").output, "a\nb\nc\nd\n");
}

TEST(Subprocess, VariablesAreAddedOrReplaced) {
  const auto result = RunProcess(ProcessRequest{.argv = {"sh", "-c", "echo \"$OWN|$PATH|${HOME:+home}\""},
                                                .variables = {{"OWN", "a b"}, {"PATH", "/usr/bin:/bin"}}});
  EXPECT_EQ(result.output.substr(0, result.output.rfind('|')), "a b|/usr/bin:/bin");
}

TEST(Subprocess, CallsBackWhileTheChildRuns) {
  int calls = 0;
  RunProcess(ProcessRequest{.argv = {"sleep", "0.3"}, .while_running = [&] { ++calls; }});
  EXPECT_GE(calls, 2);
}

}  // namespace
}  // namespace oraclegs
