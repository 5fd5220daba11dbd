#include "oraclegs/image/codecs.h"
#include "oraclegs/stages/stage_works.h"
#include "run/fixtures.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;

/// A scene whose masks a command makes: it copies one for all photos, and notes that it ran.
class MasksStageTest : public testing::Test {
 protected:
  MasksStageTest() {
    Image8 mask{48, 36, 1, std::vector<uint8_t>(48 * 36, 255)};
    std::fill_n(mask.data.begin(), 48 * 9, 0);
    WritePng(temp / "mask.png", mask);
    request.options.masks.masks = "echo x >> " + (temp / "calls").string() + "; for f in {request}/*; do cp " +
                                  (temp / "mask.png").string() + " {answer}/$(basename $f); done";
  }
  std::string Calls() const { return ReadFile(temp / "calls"); }

  TempDir temp;
  RunRequest request = TinyRequest(MakeTinyScene(temp / "scene"), temp / "out");
  EventRecorder events;
};

TEST_F(MasksStageTest, RunsTheCommandOnceAndMasksAllViews) {
  {
    const auto run = StartRun(request, Silent());
    for (const SceneView& view : run.scene.views) EXPECT_EQ(view.mask_path.parent_path(), run.workspace.masks());
    EXPECT_EQ(LoadViews(run.scene, {0}, run.plan.image, Silent()).front().mask[0], 0);
    EXPECT_EQ(run.workspace.Record("masks").at("photos"), 6);
  }
  StartRun(request, Silent());
  OpenRun(request, Silent());
  EXPECT_EQ(Calls(), "x\n");
}

TEST_F(MasksStageTest, RunsAgainForAnotherCommandPhotoOrADamagedMask) {
  StartRun(request, Silent());
  request.options.masks.masks += " # 2";
  StartRun(request, Silent());
  EXPECT_EQ(Calls(), "x\nx\n");
  WriteText(temp / "out/masks/images_000.png", "damaged");
  StartRun(request, events.AsListener());
  EXPECT_EQ(Calls(), "x\nx\nx\n");
  EXPECT_THAT(events.warnings, testing::Contains(HasSubstr("stage masks is made again")));
  std::filesystem::copy_file(temp / "scene/images/001.png", temp / "scene/images/000.png",
                             std::filesystem::copy_options::overwrite_existing);
  StartRun(request, Silent());
  EXPECT_EQ(Calls(), "x\nx\nx\nx\n");
}

TEST_F(MasksStageTest, WinOverMasksOfTheScene) {
  WriteText(temp / "scene/masks/000.png", "damaged");
  const auto run = StartRun(request, events.AsListener());
  EXPECT_THAT(events.notes, testing::Contains(HasSubstr("are not used: the command of --masks makes others")));
  EXPECT_EQ(run.scene.views[0].mask_path.parent_path(), run.workspace.masks());
}

TEST_F(MasksStageTest, ArePartOfTheKeyOfFoundPoses) {
  auto run = StartRun(request, Silent());
  run.photos = "x";
  const std::string masked = StageKey(&run, Stages(), "register");
  run.options.masks.masks.clear();
  EXPECT_NE(StageKey(&run, Stages(), "register"), masked);
}

TEST_F(MasksStageTest, IsNotWantedWithoutACommand) {
  request.options.masks.masks.clear();
  const auto run = StartRun(request, Silent());
  EXPECT_FALSE(MasksStage().wanted(run));
  EXPECT_FALSE(std::filesystem::exists(run.workspace.masks()));
}

}  // namespace
}  // namespace oraclegs
