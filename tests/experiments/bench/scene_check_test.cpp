#include "oraclegs/experiments/bench/scene_check.h"

#include <gmock/gmock.h>

#include "run/fixtures.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

/// A suite whose scenes are demo scenes of 12 views.
Suite DemoSuite(int side) {
  return {.name = "demo",
          .label = "Demo",
          .scenes = {"one", "two"},
          .folders = {"."},
          .formats = {SceneFormat::kTransforms},
          .views = {3, 20},
          .protocol =
              [](int views) {
                return RunArguments{{"views", std::to_string(views)}, {"test-every", "4"}, {"downscale", "2"}};
              },
          .min_side = side,
          .max_side = side};
}

class SceneCheckTest : public testing::Test {
 protected:
  void SetUp() override { MakeTinyScene(scene.path, 12); }
  TempDir dir;
  SuiteScene scene{"one", dir / "one"};
};

TEST_F(SceneCheckTest, NamesTheImagesAndTheirSize) {
  const auto checks = CheckScene(DemoSuite(24), scene, {3, 20}, {});
  ASSERT_EQ(checks.size(), 2u);
  EXPECT_EQ(checks[0].problem, "");
  EXPECT_THAT(checks[0].test, ElementsAre("images/000.png", "images/004.png", "images/008.png"));
  EXPECT_THAT(checks[0].train, ElementsAre("images/001.png", "images/006.png", "images/011.png"));
  EXPECT_EQ(checks[0].width, 24);
  EXPECT_THAT(checks[1].problem, AllOf(HasSubstr("one"), HasSubstr("--views asks for 20"), HasSubstr("only 9")));
  EXPECT_THAT(CheckText(checks),
              AllOf(HasSubstr("one, 3 views: 3 training images (images/001.png, "), HasSubstr(", 3 test images ("),
                    HasSubstr("24x18 pixels\n"), HasSubstr("one, 20 views: cannot be run: ")));
}

TEST_F(SceneCheckTest, RefusesAnotherSize) {
  EXPECT_THAT(CheckScene(DemoSuite(400), scene, {3}, {})[0].problem,
              AllOf(HasSubstr(scene.path.string()), HasSubstr("24x18"), HasSubstr("400 pixels wide")));
  EXPECT_EQ(CheckScene(DemoSuite(400), scene, {3}, {{"downscale", "1"}})[0].problem, "") << "as the user asked";
  EXPECT_THAT(CheckScene(DemoSuite(24), scene, {3}, {{"smaller-copies", "required"}})[0].problem,
              AllOf(HasSubstr("images_2"), HasSubstr("001.png")));
}

TEST_F(SceneCheckTest, RefusesAnotherLayoutAndWhatIsMissing) {
  Suite suite = DemoSuite(24);
  suite.formats = {SceneFormat::kColmap};
  const auto checks = CheckScene(suite, scene, {3, 20}, {});
  EXPECT_THAT(checks[0].problem, AllOf(HasSubstr("holds transforms.json"), HasSubstr("COLMAP model")));
  EXPECT_EQ(checks[1].problem, checks[0].problem);
  EXPECT_EQ(CheckScene(suite, {"two", dir / "two"}, {3}, {})[0].problem, (dir / "two").string() + ": is missing");
}

TEST_F(SceneCheckTest, RefusesMissingImagesOfANamedSuite) {
  std::filesystem::remove(scene.path / "images/005.png");
  EXPECT_THAT(CheckScene(DemoSuite(24), scene, {3}, {})[0].problem, AllOf(HasSubstr("1 image"), HasSubstr("005.png")));
  Suite folder = DemoSuite(0);
  folder.scenes.clear();
  EXPECT_EQ(CheckScene(folder, scene, {3}, {})[0].problem, "");
}

TEST(LpipsText, SaysHowItBecomesMeasured) {
  EXPECT_THAT(LpipsText({}), AllOf(HasSubstr("VGG16"), HasSubstr("models fetch lpips-vgg")));
}

}  // namespace
}  // namespace oraclegs
