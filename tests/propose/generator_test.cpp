#include "oraclegs/propose/generator.h"

#include "oraclegs/core/files.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/image/read_image.h"
#include "propose/generator_folders.h"
#include "support/event_recorder.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

class GeneratorTest : public GeneratorFolderTest {
 protected:
  GeneratorTest() { WriteRequest(); }

  void Generate(const std::string& command, int timeout = 60) {
    RunGenerator({command, timeout, dir / "proposals"}, targets, events.AsListener());
  }
  template <class Error = RunError>
  std::string ErrorOf(const std::string& command, int timeout = 60) {
    return MessageOf<Error>([&] { Generate(command, timeout); });
  }

  const fs::path stored = dir / "proposals" / "command";
  EventRecorder events;
};

TEST_F(GeneratorTest, StoresWhatTheCommandAnswers) {
  Generate("cp {request}/warps/*.png {answer}/ && echo finished");
  for (const Target& target : targets) {
    EXPECT_EQ(ReadFile(stored / (target.name + ".png")), ReadFile(paths.request() / "warps" / (target.name + ".png")));
  }
  EXPECT_FALSE(fs::exists(paths.answer()));
  EXPECT_EQ(ReadFile(paths.log()), "finished\n");
  ASSERT_GE(events.steps.size(), 2u);
  EXPECT_EQ(events.steps.front().done, 0);
  EXPECT_EQ(events.steps.back().done, 2);
  EXPECT_EQ(events.steps.back().total, 2);
}

TEST_F(GeneratorTest, FoldersAreEnvironmentVariablesToo) {
  Generate("cp \"$ORACLEGS_REQUEST\"/warps/*.png \"$ORACLEGS_ANSWER\"");
  EXPECT_TRUE(fs::exists(stored / "aside.png"));
}

TEST_F(GeneratorTest, ReportsImagesAsTheyCome) {
  Generate("echo painting; cp {request}/warps/front.png {answer}; sleep 1.2; cp {request}/warps/aside.png {answer}");
  EXPECT_TRUE(std::any_of(events.steps.begin(), events.steps.end(), [](const StepDone& step) {
    return step.stage == "propose" && step.done == 1 && step.total == 2 && step.detail == "painting";
  }));
}

TEST_F(GeneratorTest, FailureGivesTheLastLineOfStderr) {
  EXPECT_THAT(ErrorOf("echo no memory >&2; echo bye; exit 3"),
              AllOf(HasSubstr("ended with exit code 3: no memory; "), HasSubstr("log.txt")));
  EXPECT_THAT(ErrorOf("exit 1"), HasSubstr("ended with exit code 1: it says nothing on stderr"));
  EXPECT_THAT(ErrorOf("oraclegs-no-such-program {request}"),
              AllOf(HasSubstr("exit code 127"), HasSubstr("oraclegs-no-such-program")));
}

TEST_F(GeneratorTest, IsStoppedAtItsTimeLimit) {
  EXPECT_THAT(ErrorOf("cp {request}/warps/front.png {answer}; sleep 60", 1),
              AllOf(HasSubstr("stopped after 1 s, when 1 of 2 images were there"), HasSubstr("--generator-timeout")));
  EXPECT_FALSE(fs::exists(stored));
}

TEST_F(GeneratorTest, AMissingImageIsAnError) {
  EXPECT_THAT(ErrorOf<InputError>("cp {request}/warps/front.png {answer}"), HasSubstr("aside.png: is missing"));
  EXPECT_FALSE(fs::exists(stored));
}

TEST_F(GeneratorTest, AnInterruptEndsTheCommand) {
  const Listener interrupt = [](const Event& event) {
    const auto* step = std::get_if<StepDone>(&event);
    if (step != nullptr && step->done == 1) RequestInterrupt(true);
  };
  EXPECT_THROW(
      RunGenerator({"cp {request}/warps/front.png {answer}; sleep 60", 0, dir / "proposals"}, targets, interrupt),
      Interrupted);
  RequestInterrupt(false);
}

TEST_F(GeneratorTest, RemovesItsFilesAlone) {
  Generate("cp {request}/warps/*.png {answer}/");
  fs::create_directory(dir / "proposals" / "warp");
  RemoveGeneratorFiles(dir / "proposals");
  EXPECT_FALSE(fs::exists(stored));
  EXPECT_FALSE(fs::exists(paths.root));
  EXPECT_TRUE(fs::exists(dir / "proposals" / "warp"));
}

}  // namespace
}  // namespace oraclegs
