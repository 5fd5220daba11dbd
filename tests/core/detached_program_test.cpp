#include "oraclegs/core/detached_program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <nlohmann/json.hpp>
#include <thread>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;

/// Waits, at most a minute.
void WaitUntil(const std::function<bool()>& done) {
  for (int i = 0; i < 6000 && !done(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
}

std::string LogText(const std::filesystem::path& file) { return ReadHead(file, 1000); }

TEST(StartDetached, WritesToTheLogAndIsGoneThen) {
  const TempDir dir;
  WriteText(dir / "log", "before\n");
  const ProcessMark mark =
      StartDetached({"sh", "-c", "echo out; echo err >&2; cat; ls /proc/self/fd | wc -l"}, dir / "log");
  EXPECT_GT(mark.number, 1);
  EXPECT_GT(mark.started, 0);
  WaitUntil([&] { return StateOf(mark) == ProgramState::kGone; });
  EXPECT_EQ(StateOf(mark), ProgramState::kGone);
  EXPECT_THAT(LogText(dir / "log"), testing::StartsWith("before\nout\nerr\n4"));  // 0, 1, 2 and the folder itself
  EXPECT_FALSE(SignalSession(mark, SIGCONT));
}

TEST(StartDetached, NamesWhatIsMissing) {
  const TempDir dir;
  try {
    StartDetached({"/no/such/program"}, dir / "log");
    FAIL();
  } catch (const RunError& error) {
    EXPECT_THAT(error.what(), HasSubstr("/no/such/program: there is no such program"));
  }
  EXPECT_THROW(StartDetached({"sh"}, dir / "none" / "log"), RunError);
}

TEST(SignalSession, PausesAndEndsTheProgramWithItsChildren) {
  const TempDir dir;
  // The child has a process group of its own, as those that this program starts.
  const ProcessMark mark = StartDetached(
      {"bash", "-c", "set -m; bash -c 'for i in $(seq 600); do sleep .1; done; echo late' & echo $!; wait -f"},
      dir / "log");
  WaitUntil([&] { return !LogText(dir / "log").empty(); });
  const std::string child = LogText(dir / "log").substr(0, LogText(dir / "log").find('\n'));
  const auto state_of_child = [&] {
    const std::string line = LogText(std::filesystem::path("/proc") / child / "stat");
    return line.empty() ? 'Z' : line[line.rfind(')') + 2];
  };
  ASSERT_TRUE(SignalSession(mark, SIGSTOP));
  WaitUntil([&] { return StateOf(mark) == ProgramState::kPaused && state_of_child() == 'T'; });
  EXPECT_EQ(StateOf(mark), ProgramState::kPaused);
  EXPECT_EQ(state_of_child(), 'T');
  ASSERT_TRUE(SignalSession(mark, SIGCONT));
  WaitUntil([&] { return StateOf(mark) == ProgramState::kRuns; });
  EXPECT_EQ(StateOf(mark), ProgramState::kRuns);
  ASSERT_TRUE(SignalSession(mark, SIGTERM));
  WaitUntil([&] { return StateOf(mark) == ProgramState::kGone && state_of_child() == 'Z'; });
  EXPECT_EQ(StateOf(mark), ProgramState::kGone);
  EXPECT_EQ(state_of_child(), 'Z');
}

TEST(StateOf, KnowsANumberThatWasGivenAnew) {
  const TempDir dir;
  ProcessMark mark = StartDetached({"sleep", "60"}, dir / "log");
  EXPECT_NE(StateOf(mark), ProgramState::kGone);
  ProcessMark other = mark;
  ++other.started;
  EXPECT_EQ(StateOf(other), ProgramState::kGone);
  EXPECT_FALSE(SignalSession(other, SIGKILL));
  EXPECT_TRUE(SignalSession(mark, SIGKILL));
  WaitUntil([&] { return StateOf(mark) == ProgramState::kGone; });
  EXPECT_EQ(StateOf({}), ProgramState::kGone);
  EXPECT_EQ(StateOf({1, 0}), ProgramState::kGone);
}

TEST(ProcessMark, SurvivesJson) {
  const ProcessMark mark = ProcessMarkFromJson(ProcessMarkToJson({4711, 99}));
  EXPECT_EQ(mark.number, 4711);
  EXPECT_EQ(mark.started, 99);
  for (const char* text : {"null", "[]", "{}", R"({"number": "7", "started": 1})", R"({"number": -1, "started": 1})"}) {
    EXPECT_EQ(ProcessMarkFromJson(nlohmann::json::parse(text)).number, 0) << text;
  }
}

}  // namespace
}  // namespace oraclegs
