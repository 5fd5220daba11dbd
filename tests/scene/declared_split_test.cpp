#include "oraclegs/scene/declared_split.h"

#include <nlohmann/json.hpp>

#include "scene/tiny_scenes.h"
#include "support/event_recorder.h"

namespace oraclegs {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr DeclaredRole kNone = DeclaredRole::kNone, kTrain = DeclaredRole::kTrain, kTest = DeclaredRole::kTest,
                       kVal = DeclaredRole::kVal;

Scene SceneWithRoles(const std::vector<DeclaredRole>& roles) {
  Scene scene;
  scene.root = "SCENE";
  scene.format = SceneFormat::kTransforms;
  for (const DeclaredRole role : roles) {
    SceneView view;
    view.name = std::to_string(scene.views.size()) + ".png";
    view.role = role;
    scene.views.push_back(view);
  }
  return scene;
}

TEST(RolesInTransforms, FollowsItsLists) {
  const std::vector<std::string> frames = {"images/0.png", "./images/1.png", "images\\2.png", "3.png", "4.png"};
  const json lists = {{"train_filenames", {"images/0.png", "images/1.png", "gone.png"}},
                      {"val_filenames", {"3.png", "images/2.png"}},
                      {"test_filenames", {"images/2.png"}}};
  EventRecorder events;
  const auto roles_of = [&](const json& file) { return RolesInTransforms(file, frames, "FILE", events.AsListener()); };
  EXPECT_THAT(roles_of(lists), ElementsAre(kTrain, kTrain, kTest, kVal, kNone));
  EXPECT_THAT(events.warnings, ElementsAre(AllOf(HasSubstr("FILE: its lists of training and test views have 1 name"),
                                                 HasSubstr("left out: gone.png"))));
  EXPECT_THAT(roles_of({{"val_filenames", {"3.png"}}, {"test_filenames", json::array()}}),
              ElementsAre(kNone, kNone, kNone, kTest, kNone));
  EXPECT_THAT(roles_of({{"train_filenames", 3}, {"test_filenames", {1}}}),
              ElementsAre(kNone, kNone, kNone, kNone, kNone));
  EXPECT_EQ(events.warnings.size(), 1u);
}

TEST(RolesInTransforms, ComparesExtensionsWhereTheyTellFramesApart) {
  EventRecorder events;
  const std::vector<std::string> frames = {"a.v1", "a.v2.png", "b.jpg", "c.jpg", "c.png"};
  EXPECT_THAT(
      RolesInTransforms({{"test_filenames", {"a.v1.png", "b", "c.png", "c.heic"}}, {"train_filenames", {"a.v2"}}},
                        frames, "FILE", events.AsListener()),
      ElementsAre(kTest, kTrain, kTest, kNone, kTest));
  EXPECT_THAT(events.warnings, ElementsAre(HasSubstr("left out: c.heic")));
}

TEST(SplitViews, TakesDeclaredListsUnlessAnOptionSaysOtherwise) {
  const Scene scene = SceneWithRoles({kTrain, kTrain, kTest, kVal, kNone, kTrain});
  EXPECT_THAT(SplitViews(scene, {}).train, ElementsAre(0, 1, 5));
  EXPECT_THAT(SplitViews(scene, {}).test, ElementsAre(2));
  EXPECT_THAT(SplitViews(scene, {.eval = true}).test, ElementsAre(0));
  EXPECT_THAT(SplitViews(scene, {.views = 2}).train, ElementsAre(0, 5));
  EXPECT_THAT(SplitViews(scene, {.test_every = 0}).train, ElementsAre(0, 1, 2, 3, 4, 5));
  EXPECT_THAT(SplitViews(scene, {.test_views = "0"}).train, ElementsAre(1, 2, 3, 4, 5));
  const Scene without_train = SceneWithRoles({kNone, kNone, kTest, kVal});
  EXPECT_THAT(SplitViews(without_train, {}).train, ElementsAre(0, 1));
}

TEST(ReportDeclaredSplit, CountsViews) {
  EventRecorder events;
  ReportDeclaredSplit(SceneWithRoles({kNone, kNone}), "FILE", events.AsListener());
  EXPECT_THAT(events.notes, IsEmpty());
  ReportDeclaredSplit(SceneWithRoles({kTrain, kTrain, kTest, kNone}), "FILE", events.AsListener());
  EXPECT_THAT(events.notes,
              ElementsAre(HasSubstr("FILE: its lists name 2 training views and 1 test view, and 1 are in neither")));
}

TEST(ReportSplitLists, NamesListsAndTheirOptions) {
  TempDir dir;
  Scene scene = SceneWithRoles({kNone, kNone, kNone});
  scene.root = dir.path();
  WriteText(dir / "test.txt", "1.png\n");
  WriteText(dir / "train.txt", "of something else\n");
  EventRecorder events;
  ReportSplitLists(scene, {.test_views = "1"}, events.AsListener());
  EXPECT_THAT(events.notes, IsEmpty());
  ReportSplitLists(scene, {}, events.AsListener());
  EXPECT_THAT(events.notes, ElementsAre(AllOf(HasSubstr("--test-views @" + (dir / "test.txt").string()),
                                              ::testing::Not(HasSubstr("--train-views")))));
}

}  // namespace
}  // namespace oraclegs
