#include "oraclegs/core/user_command.h"

#include <gmock/gmock.h>

#include "oraclegs/core/files.h"
#include "oraclegs/core/interrupt.h"
#include "support/errors.h"
#include "support/event_recorder.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

class UserCommandTest : public testing::Test {
 protected:
  UserCommandTest() { EmptyCommandFolders(folders); }

  AwaitedAnswers Awaited() const {
    return {"masks", "masks", 2,
            [this] { return static_cast<size_t>(std::distance(fs::directory_iterator(folders.answer()), {})); }};
  }
  void RunText(const std::string& text, int timeout = 60) {
    RunUserCommand({"--masks", text, timeout, folders}, Awaited(), events.AsListener());
  }
  std::string ErrorOf(const std::string& text, int timeout = 60) {
    return MessageOf<RunError>([&] { RunText(text, timeout); });
  }

  TempDir dir;
  CommandFolders folders{dir / "it's here"};
  EventRecorder events;
};

TEST_F(UserCommandTest, KnowsItsFoldersAndReportsAnswers) {
  RunText(
      "touch {answer}/a; echo half; sleep 1.2; touch \"$ORACLEGS_ANSWER\"/b; test \"$ORACLEGS_REQUEST\" = {request}");
  EXPECT_TRUE(fs::exists(folders.answer() / "a"));
  EXPECT_TRUE(fs::exists(folders.answer() / "b"));
  EXPECT_EQ(ReadFile(folders.log()), "half\n");
  ASSERT_GE(events.steps.size(), 3u);
  EXPECT_EQ(events.steps.front().done, 0);
  EXPECT_TRUE(std::any_of(events.steps.begin(), events.steps.end(), [](const StepDone& step) {
    return step.stage == "masks" && step.done == 1 && step.total == 2 && step.detail == "half";
  }));
  EXPECT_EQ(events.steps.back().done, 2);
}

TEST_F(UserCommandTest, FailureNamesTheOptionAndTheLastLineOfStderr) {
  EXPECT_THAT(ErrorOf("echo no memory >&2; echo bye; exit 3"),
              AllOf(HasSubstr("--masks: the command ended with exit code 3: no memory; "), HasSubstr("log.txt")));
  EXPECT_THAT(ErrorOf("exit 1"), HasSubstr("exit code 1: it says nothing on stderr"));
}

TEST_F(UserCommandTest, IsStoppedAtItsTimeLimit) {
  EXPECT_THAT(ErrorOf("touch {answer}/a; sleep 60", 1),
              AllOf(HasSubstr("stopped after 1 s, when 1 of 2 images were there"), HasSubstr("--generator-timeout")));
}

TEST(CommandFolders, AreEmptied) {
  const TempDir dir;
  const CommandFolders folders{dir / "c"};
  WriteText(folders.answer() / "old", "");
  WriteText(folders.log(), "");
  EmptyCommandFolders(folders);
  EXPECT_TRUE(fs::is_empty(folders.answer()));
  EXPECT_FALSE(fs::exists(folders.log()));
  WriteText(dir / "file", "");
  EXPECT_THROW(EmptyCommandFolders({dir / "file" / "c"}), RunError);
}

TEST(RequireUtf8Command, NamesTheOption) {
  RequireUtf8Command("--masks", "ü");
  EXPECT_THAT(MessageOf<UsageError>([] { RequireUtf8Command("--masks", "\xff"); }),
              HasSubstr("--masks is not valid UTF-8: "));
}

TEST(FilledCommand, QuotesTheFoldersForTheShell) {
  EXPECT_EQ(FilledCommand("a {request} b{answer}{other} {request", {"/it's here"}),
            "a '/it'\\''s here/request' b'/it'\\''s here/answer'{other} {request");
}

}  // namespace
}  // namespace oraclegs
