#include "oraclegs/capture/mask_command.h"

#include <gmock/gmock.h>

#include "image/jpeg_files.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/user_command.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/scene/masks.h"
#include "support/errors.h"
#include "support/event_recorder.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

class MaskCommandTest : public testing::Test {
 protected:
  MaskCommandTest() {
    for (const char* name : {"left/a.png", "left/b.png"}) {
      SceneView view;
      view.name = name;
      view.image_path = dir / "scene" / name;
      view.intrinsics.width = 8, view.intrinsics.height = 6;
      WritePng(view.image_path, SmoothImage(8, 6, 3));
      scene.views.push_back(view);
    }
    Store("good.png", 8, 6, 255);
    Store("black.png", 8, 6, 0);
    Store("ones.png", 8, 6, 1);
    Store("half.png", 4, 3, 255);
    Store("other.png", 8, 5, 255);
  }

  void Store(const std::string& name, int width, int height, uint8_t level) {
    Image8 mask{width, height, 1, std::vector<uint8_t>(static_cast<size_t>(width * height), level)};
    mask.data[0] = 0;
    WritePng(dir / name, mask);
  }
  void Make(const std::string& command, int timeout = 60) {
    MakeMasks({command, timeout, dir / "masks"}, scene, events.AsListener());
  }
  /// A command that answers with these files.
  std::string Answers(const std::string& a, const std::string& b) const {
    return fmt::format("cp '{}' {{answer}}/left_a.png; cp '{}' {{answer}}/left_b.png", (dir / a).string(),
                       (dir / b).string());
  }
  template <class Error = InputError>
  std::string ErrorOf(const std::string& command, int timeout = 60) {
    return MessageOf<Error>([&] { Make(command, timeout); });
  }

  TempDir dir;
  Scene scene;
  EventRecorder events;
};

TEST_F(MaskCommandTest, GivesThePhotosAndTakesTheMasks) {
  Make(Answers("good.png", "half.png") + "; cp {request}/left_b.png " + (dir / "seen.png").string());
  EXPECT_EQ(ReadImage(dir / "seen.png").data, ReadImage(scene.views[1].image_path).data);
  EXPECT_FALSE(fs::exists(dir / "masks" / "command" / "request")) << "copies take room";
  EXPECT_EQ(events.steps.back().stage, "masks");
  EXPECT_EQ(events.steps.back().done, 2);
  TakeMasks(dir / "masks", events.AsListener(), &scene);
  EXPECT_EQ(scene.views[0].mask_path, dir / "masks" / "left_a.png");
  EXPECT_EQ(ReadFile(scene.views[0].mask_path), ReadFile(dir / "good.png"));
  EXPECT_THAT(events.notes, testing::ElementsAre(HasSubstr("scaled to them"))) << "masks may be smaller";
}

TEST_F(MaskCommandTest, AddsToTheMaskThatAFaceHas) {
  Image8 own{8, 6, 1, std::vector<uint8_t>(48, 255)};
  std::fill_n(own.data.begin() + 40, 8, uint8_t{0});  // a face of a fisheye photo, which shows nothing here
  WritePng(dir / "own.png", own);
  scene.views[0].mask_path = dir / "own.png";
  scene.views[0].sphere.emplace();
  for (const char* answer : {"good.png", "ones.png"}) {
    Make(Answers(answer, answer));
    Scene taken = scene;
    TakeMasks(dir / "masks", events.AsListener(), &taken);
    const Image8 mask = ReadMask(taken.views[0], 8, 6, Orientation::kUpright);
    EXPECT_EQ(std::count(mask.data.begin(), mask.data.end(), 0), 9) << answer << ": its pixel and the row";
    EXPECT_EQ(std::count(mask.data.begin() + 40, mask.data.end(), 0), 8);
    const Image8 other = ReadMask(taken.views[1], 8, 6, Orientation::kUpright);
    EXPECT_EQ(std::count(other.data.begin(), other.data.end(), 0), 1);
  }
}

TEST_F(MaskCommandTest, GivesPhotosUprightUnlessTheirCamerasAreOfThePixelsAsStored) {
  SceneView& view = scene.views[0];
  view.image_path = dir / "turned.jpg";
  WriteText(view.image_path, WithOrientation(EncodeJpeg(SmoothImage(8, 6, 3)), 6));
  view.intrinsics.width = 6, view.intrinsics.height = 8;
  const std::string copy = "; cp {request}/left_a.png " + (dir / "seen.png").string();
  ErrorOf("true" + copy);
  EXPECT_EQ(ReadImage(dir / "seen.png").height, 8);
  view.intrinsics.width = 8, view.intrinsics.height = 6, view.as_stored = true;
  ErrorOf("true" + copy);
  EXPECT_EQ(ReadImage(dir / "seen.png").height, 6);
}

TEST_F(MaskCommandTest, TakesZeroAndOneAsOtherMasksAre) {
  Make(Answers("ones.png", "ones.png"));
  TakeMasks(dir / "masks", events.AsListener(), &scene);
  EXPECT_EQ(scene.views[0].mask_white, 1);
}

TEST_F(MaskCommandTest, MissingMasksAreCountedAndTheFirstIsNamed) {
  EXPECT_THAT(ErrorOf("cp '" + (dir / "good.png").string() + "' {answer}/left_a.png"),
              AllOf(HasSubstr("answer/left_b.png: is missing"), HasSubstr("wrote 1 of 2"), HasSubstr("log.txt")));
  EXPECT_FALSE(fs::exists(dir / "masks" / "left_a.png"));
}

TEST_F(MaskCommandTest, WrongMasksAreErrorsThatNameTheFile) {
  EXPECT_THAT(ErrorOf(Answers("good.png", "other.png")),
              AllOf(HasSubstr("answer/left_b.png: is 8 x 5"), HasSubstr("is 8 x 6")));
  EXPECT_THAT(ErrorOf(Answers("good.png", "black.png")), HasSubstr("left_b.png: this mask ignores every pixel"));
  WriteText(dir / "rubbish.png", "no image");
  EXPECT_THAT(ErrorOf(Answers("good.png", "rubbish.png")), HasSubstr("left_b.png: "));
  EXPECT_FALSE(fs::exists(dir / "masks" / "left_a.png"));
}

TEST_F(MaskCommandTest, FailureAndTimeLimitAreOneLine) {
  EXPECT_THAT(ErrorOf<RunError>("echo no network >&2; exit 2"),
              HasSubstr("--masks: the command ended with exit code 2: no network"));
  EXPECT_THAT(ErrorOf<RunError>("sleep 60", 1), HasSubstr("--masks: the command was stopped after 1 s, when 0 of 2"));
}

TEST_F(MaskCommandTest, AMaskThatIsGoneIsNamed) {
  EXPECT_THAT(MessageOf<InputError>([&] { TakeMasks(dir / "masks", Silent(), &scene); }),
              HasSubstr("left_a.png: no such file"));
}

}  // namespace
}  // namespace oraclegs
