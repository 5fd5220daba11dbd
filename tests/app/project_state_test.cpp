#include "oraclegs/app/project_state.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>

#include "app/fake_program.h"
#include "support/wait_until.h"

namespace oraclegs {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class ProjectStateTest : public testing::Test {
 protected:
  ProjectState Now() const { return StateOf(library.Find(project.id).value()); }
  void WriteLive(const std::string& json) const { WriteText(project.paths.splat() / "live" / "state.json", json); }
  void Started() {
    library.Update(project.id, [](ProjectRecord* record) { record->started = true; });
  }

  TempDir dir;
  Library library{dir / "library"};
  Project project = MakeProject(&library, 3);
};

TEST_F(ProjectStateTest, FollowsWhatTheRunWrites) {
  EXPECT_EQ(Now().phase, ProjectPhase::kNew);
  library.Update(project.id, [](ProjectRecord* record) { record->queued = 2; });
  EXPECT_EQ(Now().phase, ProjectPhase::kWaiting);
  library.Update(project.id, [](ProjectRecord* record) { record->queued = 0; });
  WriteLive(R"({"state": "finished", "message": ""})");
  EXPECT_EQ(Now().phase, ProjectPhase::kFinished);
  WriteLive(R"({"state": "failed", "message": "a.jpg: cannot be read"})");
  EXPECT_EQ(Now().phase, ProjectPhase::kFailed);
  EXPECT_EQ(Now().message, "a.jpg: cannot be read");
  WriteLive(R"({"state": "interrupted", "message": "stopped"})");
  EXPECT_EQ(Now().phase, ProjectPhase::kStopped);
  WriteLive(R"({"state": "running", "lock": true})");
  EXPECT_EQ(Now().phase, ProjectPhase::kStopped) << "it was killed";
  EXPECT_THAT(Now().message, HasSubstr("start it again here")) << "people of the page type no command";
}

TEST_F(ProjectStateTest, AStartThatFailedAtItsInputSaysWhy) {
  Started();
  WriteText(project.paths.log(), "info: looks\nerror: a.jpg: is no image\n");
  EXPECT_EQ(Now().phase, ProjectPhase::kFailed);
  EXPECT_EQ(Now().message, "a.jpg: is no image");
  WriteLive(R"({"state": "finished"})");
  EXPECT_EQ(Now().phase, ProjectPhase::kFinished) << "the splat of the run before is there";
  EXPECT_EQ(Now().message, "a.jpg: is no image");
}

TEST_F(ProjectStateTest, AProcessRunsOrIsPaused) {
  const ProcessMark process = StartDetached({"sleep", "60"}, dir / "log");
  library.Update(project.id, [&](ProjectRecord* record) { record->process = process; });
  EXPECT_EQ(Now().phase, ProjectPhase::kRunning);
  EXPECT_FALSE(IsAtRest(Now().phase));
  SignalSession(process, SIGSTOP);
  EXPECT_TRUE(WaitUntil([&] { return Now().phase == ProjectPhase::kPaused; }));
  SignalSession(process, SIGKILL);
  EXPECT_TRUE(WaitUntil([&] { return IsAtRest(Now().phase); }));
}

TEST_F(ProjectStateTest, AnotherProgramMayWriteIt) {
  std::filesystem::create_directories(project.paths.splat());
  const FolderLock lock(project.paths.splat());
  EXPECT_EQ(Now().phase, ProjectPhase::kElsewhere);
}

TEST_F(ProjectStateTest, ShowsTheEndOfTheLog) {
  EXPECT_THAT(LastLines(project.paths, 2), IsEmpty());
  WriteText(project.paths.log(), "1\n2\n3\x1b[31m\n");
  EXPECT_THAT(LastLines(project.paths, 2), ElementsAre("2", "3?[31m"));
  WriteText(project.paths.log(), std::string(100'000, 'x') + "\nlast\n");
  EXPECT_THAT(LastLines(project.paths, 5), ElementsAre("last")) << "half a line is none";
}

TEST(StageInWords, NamesEveryStageOfARun) {
  EXPECT_EQ(StageInWords("train"), "Making the splat");
  EXPECT_EQ(StageInWords("something new"), "something new");
}

}  // namespace
}  // namespace oraclegs
