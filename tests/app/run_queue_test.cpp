#include "oraclegs/app/run_queue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/fake_program.h"
#include "oraclegs/app/project_state.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "support/errors.h"
#include "support/file_size_limit.h"
#include "support/wait_until.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;
using testing::Not;

/// A run that goes on until it is asked to stop.
constexpr const char* kLongRun = R"(trap 'echo stopped >> "$(dirname "$0")/calls"; exit 130' INT
while true; do sleep .05; done)";

class RunQueueTest : public testing::Test {
 protected:
  Project Now(const Project& project) const { return library.Find(project.id).value(); }
  bool Reaches(const Project& project, ProjectPhase phase) const {
    return WaitUntil([&] { return StateOf(Now(project)).phase == phase; });
  }

  TempDir dir;
  Library library{dir / "library"};
  std::filesystem::path program = WriteFakeProgram(dir.path(), kLongRun);
  Project first = MakeProject(&library, 3, "first"), second = MakeProject(&library, 4, "second");
};

TEST_F(RunQueueTest, StartsOneAfterTheOther) {
  RunQueue queue(program, &library);
  queue.Add(first, "draft", "cpu");
  EXPECT_TRUE(Reaches(first, ProjectPhase::kRunning));
  EXPECT_THAT(ReadFile(dir / "calls"), HasSubstr("reconstruct " + first.paths.photos().string() + " --out " +
                                                 first.paths.splat().string() + " --quality draft --device cpu"));
  queue.Add(second, "normal", "auto");
  EXPECT_EQ(StateOf(Now(second)).phase, ProjectPhase::kWaiting);
  EXPECT_EQ(queue.PositionOf(Now(second)), 1);
  queue.Stop(Now(first));
  EXPECT_TRUE(Reaches(second, ProjectPhase::kRunning));
  EXPECT_EQ(StateOf(Now(first)).phase, ProjectPhase::kStopped);
  EXPECT_THAT(ReadFile(dir / "calls"), HasSubstr("stopped")) << "it had time to save";
  queue.Stop(Now(second));
  EXPECT_TRUE(Reaches(second, ProjectPhase::kStopped));
}

TEST_F(RunQueueTest, OneThatWaitsLeavesTheQueue) {
  RunQueue queue(program, &library);
  queue.Add(first, "draft", "cpu");
  EXPECT_TRUE(Reaches(first, ProjectPhase::kRunning));
  queue.Add(second, "draft", "cpu");
  queue.Stop(Now(second));
  EXPECT_EQ(StateOf(Now(second)).phase, ProjectPhase::kNew);
  queue.Stop(Now(first));
  EXPECT_TRUE(Reaches(first, ProjectPhase::kStopped));
}

TEST_F(RunQueueTest, PausesAndGoesOn) {
  RunQueue queue(program, &library);
  EXPECT_FALSE(RunQueue::Pause(first));
  queue.Add(first, "draft", "cpu");
  EXPECT_TRUE(Reaches(first, ProjectPhase::kRunning));
  EXPECT_FALSE(RunQueue::Resume(Now(first)));
  EXPECT_TRUE(RunQueue::Pause(Now(first)));
  EXPECT_TRUE(Reaches(first, ProjectPhase::kPaused));
  EXPECT_TRUE(RunQueue::Resume(Now(first)));
  EXPECT_TRUE(Reaches(first, ProjectPhase::kRunning));
  EXPECT_TRUE(RunQueue::Pause(Now(first)));
  queue.Stop(Now(first));
  EXPECT_TRUE(Reaches(first, ProjectPhase::kStopped)) << "also out of a pause";
}

TEST_F(RunQueueTest, ARunOutlivesTheAppAndTheNextOneFindsIt) {
  {
    RunQueue queue(program, &library);
    queue.Add(first, "draft", "cpu");
    EXPECT_TRUE(Reaches(first, ProjectPhase::kRunning));
    queue.Add(second, "draft", "cpu");
  }
  EXPECT_EQ(StateOf(Now(first)).phase, ProjectPhase::kRunning);
  EXPECT_EQ(StateOf(Now(second)).phase, ProjectPhase::kWaiting);
  RunQueue queue(program, &library);
  queue.Stop(Now(first));
  EXPECT_TRUE(Reaches(second, ProjectPhase::kRunning));
  queue.Stop(Now(second));
  EXPECT_TRUE(Reaches(second, ProjectPhase::kStopped));
}

TEST_F(RunQueueTest, VideosAndArchivesAreInputsOfTheirOwn) {
  WriteText(first.paths.media() / "walk.mp4", std::string("\0\0\0\x18", 4) + "ftypmp42");
  EXPECT_THAT(ReconstructArgv("oraclegs", first),
              testing::ElementsAre("oraclegs", "reconstruct", first.paths.photos(), first.paths.media() / "walk.mp4",
                                   "--out", first.paths.splat(), "--quality", "normal", "--device", "auto"));
}

TEST_F(RunQueueTest, FewPhotosAreRefused) {
  RunQueue queue(program, &library);
  const Project few = MakeProject(&library, 2, "few");
  EXPECT_THAT(MessageOf<InputError>([&] { queue.Add(few, "draft", "cpu"); }), HasSubstr("three photos"));
  WriteText(few.paths.media() / "all.zip", "PK\x03\x04");
  queue.Add(few, "draft", "cpu");
  EXPECT_TRUE(Reaches(few, ProjectPhase::kRunning));
  queue.Stop(Now(few));
  EXPECT_TRUE(Reaches(few, ProjectPhase::kStopped));
}

TEST_F(RunQueueTest, AProgramThatCannotStartIsAFailureInWords) {
  RunQueue queue(dir / "nothing", &library);
  queue.Add(first, "draft", "cpu");
  EXPECT_TRUE(Reaches(first, ProjectPhase::kFailed));
  EXPECT_THAT(StateOf(Now(first)).message, HasSubstr("there is no such program"));
}

TEST_F(RunQueueTest, ADiskThatTakesNothingIsAFailureInWords) {
  RunQueue queue(program, &library);
  queue.Add(first, "draft", "cpu");
  EXPECT_TRUE(Reaches(first, ProjectPhase::kRunning));
  queue.Add(second, "draft", "cpu");
  {
    const FileSizeLimit full(0);
    SignalProgram(Now(first).record.process, SIGINT);
    EXPECT_TRUE(Reaches(second, ProjectPhase::kFailed));
    EXPECT_THAT(StateOf(Now(second)).message, HasSubstr("File too large"));
    EXPECT_EQ(queue.PositionOf(Now(second)), 0);
  }
  EXPECT_THAT(ReadFile(dir / "calls"), Not(HasSubstr(second.paths.photos().string() + " "))) << "nothing was started";
  queue.Add(second, "draft", "cpu");
  EXPECT_TRUE(Reaches(second, ProjectPhase::kRunning)) << "with room again";
  queue.Stop(Now(second));
  EXPECT_TRUE(Reaches(second, ProjectPhase::kStopped));
}

}  // namespace
}  // namespace oraclegs
