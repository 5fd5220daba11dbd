#include "oraclegs/run/start.h"

#include <nlohmann/json.hpp>

#include "oraclegs/image/codecs.h"
#include "run/fixtures.h"
#include "support/errors.h"
#include "support/event_recorder.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class RunTest : public testing::Test {
 protected:
  TempDir temp;
  RunRequest request = TinyRequest(MakeTinyScene(temp / "scene"), temp / "out");
};

TEST_F(RunTest, WritesOptionsAndSplit) {
  EventRecorder recorder;
  const auto run = StartRun(request, recorder.AsListener());
  EXPECT_EQ(run.split.test.size(), 2u);
  EXPECT_EQ(run.split.train.size(), 4u);
  const auto split = nlohmann::json::parse(ReadFile(temp / "out" / "split.json"));
  EXPECT_EQ(split, SplitToJson(run.scene, run.split));
  ASSERT_EQ(recorder.notes.size(), 2u);
  EXPECT_THAT(recorder.notes[0], HasSubstr("4 training views: "));
  EXPECT_THAT(recorder.notes[1], HasSubstr("2 test views: "));
}

TEST_F(RunTest, LeavesNoWorkspaceBehindBadInput) {
  request.options.split.views = 99;
  EXPECT_THROW(StartRun(request, Silent()), InputError);
  request.options.split.views = -1;
  EXPECT_THROW(StartRun(request, Silent()), UsageError);
  request.options.split.views = 0;
  request.scene = temp / "nowhere";
  EXPECT_THAT(MessageOf<InputError>([&] { StartRun(request, Silent()); }), HasSubstr("nowhere"));
  EXPECT_FALSE(std::filesystem::exists(temp / "out"));
}

TEST_F(RunTest, RefusesToWriteIntoTheImageFolder) {
  std::filesystem::rename(temp / "scene" / "images", temp / "photos");
  request.options.input.images = "../photos";
  request.out = temp / "photos" / "out";
  EXPECT_THAT(MessageOf<InputError>([&] { StartRun(request, Silent()); }),
              AllOf(HasSubstr("image folder"), HasSubstr("-o")));
  EXPECT_FALSE(std::filesystem::exists(request.out));
  request.options.input.images = "\xFF";
  EXPECT_THAT(MessageOf<InputError>([&] { StartRun(request, Silent()); }), HasSubstr("\\xFF: "));
}

TEST_F(RunTest, RefusesImagesTooLargeToRender) {
  const auto plain = temp / "plain";
  std::filesystem::create_directories(plain);
  for (const char* name : {"a.png", "b.png"}) {
    WritePng(plain / name, {32770, 1, 3, std::vector<uint8_t>(size_t{32770} * 3, 7)});
  }
  request.scene = plain;
  request.options.split.test_every = 0;
  request.options.image.max_size = 0;
  EXPECT_THAT(MessageOf<InputError>([&] { StartRun(request, Silent()); }),
              AllOf(HasSubstr("a.png"), HasSubstr("32770 x 1"), HasSubstr("lower --max-size")));
  EXPECT_FALSE(std::filesystem::exists(temp / "out"));
  request.options.image.downscale = 2;
  EXPECT_THAT(MessageOf<InputError>([&] { ReadPosedScene(plain, request.options, Silent()); }), HasSubstr("no poses"));
}

TEST_F(RunTest, OpensWhatWasStarted) {
  { const auto run = StartRun(request, Silent()); }
  RunRequest open = request;
  open.scene.clear();
  EXPECT_EQ(OpenRun(open, Silent()).split.train.size(), 4u);
  open.options.image.downscale = 2;
  EXPECT_THAT(MessageOf<InputError>([&] { OpenRun(open, Silent()); }),
              AllOf(HasSubstr("--downscale was auto, now is 2"), HasSubstr("out")));
}

TEST_F(RunTest, ImportsSeveralFiles) {
  std::filesystem::copy(std::filesystem::directory_iterator(temp / "scene" / "images")->path(), temp / "a.png");
  std::filesystem::copy(temp / "a.png", temp / "b.png");
  request.scene.clear();
  request.inputs = {temp / "a.png", temp / "b.png"};
  request.options.split.test_every = 0;
  EventRecorder recorder;
  EXPECT_THAT(MessageOf<InputError>([&] { StartRun(request, recorder.AsListener()); }), HasSubstr("one and the same"));
  EXPECT_TRUE(std::filesystem::exists(temp / "out" / "photos" / "images" / "b.png"));
  EXPECT_THAT(recorder.warnings, testing::Contains(HasSubstr("a.png and b.png: show the same")));
  EXPECT_EQ(ReadSavedRun(temp / "out").inputs.size(), 2u);
  EXPECT_THAT(MessageOf<UsageError>([&] { OneFolder(request); }), HasSubstr("takes one scene folder"));
  request.inputs = {temp / "scene"};
  EXPECT_EQ(OneFolder(request), temp / "scene");
}

TEST_F(RunTest, RefusesPlainPhotosAsAPosedScene) {
  EXPECT_EQ(ReadPosedScene(request.scene, request.options, Silent()).split.test.size(), 2u);
  EXPECT_THAT(MessageOf<InputError>([&] { ReadPosedScene(temp / "scene" / "images", request.options, Silent()); }),
              HasSubstr("no poses"));
}

TEST_F(RunTest, SettlesTheSizeAnewForOtherOptions) {
  request.options.train.iterations = {};
  request.options.quality.quality = Quality::kHigh;
  const int high = StartRun(request, Silent()).options.train.iterations.value();
  EXPECT_EQ(StartRun(request, Silent()).options.train.iterations, high);
  request.options.quality.quality = Quality::kDraft;
  EXPECT_LT(StartRun(request, Silent()).options.train.iterations.value(), high);
}

TEST_F(RunTest, ADraftOfMoreThanFivePhotosPlansNoProposals) {
  request.options.quality.quality = Quality::kDraft;
  request.options.propose.proposers = {};
  EXPECT_TRUE(StartRun(request, Silent()).plan.proposes) << "four photos leave something open";
  request.options.split.test_every = {};
  const auto run = StartRun(request, Silent());
  EXPECT_EQ(run.split.train.size(), 6u);
  EXPECT_FALSE(run.plan.proposes);
  EXPECT_FALSE(run.plan.has_proposals);
}

TEST_F(RunTest, RefusesInputsInTheWorkspace) {
  request.scene.clear();
  for (const auto& input : {temp / "out" / "photos", temp / "out"}) {
    std::filesystem::create_directories(input);
    request.inputs = {input};
    EXPECT_THAT(MessageOf<InputError>([&] { StartRun(request, Silent()); }), HasSubstr("lies in the workspace"));
  }
}

}  // namespace
}  // namespace oraclegs
