#include "oraclegs/sfm/pose_check.h"
#include "oraclegs/core/files.h"
#include "oraclegs/sfm/pose_fit.h"
#include "support/event_recorder.h"
#include "support/temp_dir.h"
#include "support/textured_planes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <utility>

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// A camera of 53 degrees at `center`, turned by `yaw` radians about the vertical: at 0 it looks along z.
SceneView View(const std::string& name, const Eigen::Vector3d& center, double yaw) {
  SceneView view;
  view.name = name;
  view.intrinsics = {CameraModel::kPinhole, 100, 80, {100, 100, 50, 40}};
  Eigen::Isometry3d world_from_cam = Eigen::Isometry3d::Identity();
  world_from_cam.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitY()).toRotationMatrix();
  world_from_cam.translation() = center;
  view.cam_from_world = world_from_cam.inverse();
  return view;
}

/// n cameras on a circle of radius 3 that look at its middle.
Scene Ring(int n) {
  Scene scene;
  scene.format = SceneFormat::kTransforms;
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * std::acos(-1.) * i / n;
    scene.views.push_back(View(std::to_string(i) + ".png", {-3 * std::sin(angle), 0, -3 * std::cos(angle)}, angle));
  }
  return scene;
}

TEST(PoseWarnings, AcceptsASoundScene) {
  const Scene ring = Ring(8);
  EXPECT_THAT(PoseWarnings(ring, AllViews(ring)), IsEmpty());
  EXPECT_THAT(PoseWarnings(ring, {0, 4}), IsEmpty()) << "from opposite sides they see the same volume";
}

TEST(PoseWarnings, AcceptsParallelAxes) {
  Scene scene;
  for (int i = 0; i < 4; ++i) scene.views.push_back(View(std::to_string(i), {.1 * i, 0, 0}, 0));
  EXPECT_THAT(PoseWarnings(scene, AllViews(scene)), IsEmpty());
}

TEST(PoseWarnings, IgnoresFewerThanTwoPosedViews) {
  Scene scene = Ring(3);
  EXPECT_THAT(PoseWarnings(scene, {}), IsEmpty());
  EXPECT_THAT(PoseWarnings(scene, {1}), IsEmpty());
  scene.views[0].cam_from_world.reset();
  scene.views[1].intrinsics.params.clear();
  EXPECT_THAT(PoseWarnings(scene, AllViews(scene)), IsEmpty());
}

TEST(PoseWarnings, NamesViewsOfOnePose) {
  Scene scene = Ring(6);
  scene.views.push_back(scene.views[2]);
  scene.views.back().name = "copy.png";
  EXPECT_THAT(PoseWarnings(scene, AllViews(scene)),
              ElementsAre(AllOf(HasSubstr("2.png, copy.png have one and the same pose"), HasSubstr("leave out"))));
  EXPECT_THAT(PoseWarnings(scene, {0, 1, 2, 3, 4, 5}), IsEmpty()) << "the copy does not train";
  // Turned by a degree, from the same place: another view, though a poor one.
  scene.views.back() =
      View("turned.png", scene.views[2].cam_from_world->inverse().translation(), 2 * std::acos(-1.) / 3 + .02);
  EXPECT_THAT(PoseWarnings(scene, AllViews(scene)), IsEmpty());
}

TEST(PoseWarnings, DetectsPureRotation) {
  Scene scene;
  for (int i = 0; i < 5; ++i) scene.views.push_back(View(std::to_string(i), {4, 1, -2}, .2 * i));
  const auto warnings = PoseWarnings(scene, AllViews(scene));
  EXPECT_THAT(warnings, ElementsAre(AllOf(HasSubstr("the 5 training photos were taken from one point"),
                                          HasSubstr("depth cannot be found"), HasSubstr("move sideways"))));
}

TEST(PoseWarnings, ComparesTheBaselineWithThePoints) {
  Scene scene;
  for (int i = 0; i < 3; ++i) scene.views.push_back(View(std::to_string(i), {.001 * i, 0, 0}, 0));
  EXPECT_THAT(PoseWarnings(scene, AllViews(scene)), IsEmpty()) << "the world may be as small as that";
  for (int i = 0; i < 20; ++i) scene.points.push_back({{.1 * i - 1, 0, 10}, {}, {0, 1}});
  EXPECT_THAT(PoseWarnings(scene, AllViews(scene)), ElementsAre(HasSubstr("taken from one point")));
}

TEST(PoseWarnings, NamesAnIsolatedView) {
  Scene scene;
  for (int i = 0; i < 3; ++i) scene.views.push_back(View(std::to_string(i) + ".png", {.3 * i, 0, 0}, -.1 * (i - 1)));
  scene.views.push_back(View("away.png", {.9, 0, 0}, std::acos(-1.) / 2));
  EXPECT_THAT(PoseWarnings(scene, AllViews(scene)),
              ElementsAre(AllOf(HasSubstr("away.png sees nothing that another training photo sees"),
                                HasSubstr("between it and 2.png"))));
  EXPECT_THAT(PoseWarnings(scene, {0, 1, 2}), IsEmpty());
}

TEST(PoseWarnings, NamesViewsBackToBack) {
  Scene scene;
  scene.views = {View("a", {0, 0, 1}, 0), View("b", {0, 0, -1}, std::acos(-1.))};
  EXPECT_THAT(PoseWarnings(scene, AllViews(scene)),
              ElementsAre(AllOf(HasSubstr("a, b each see nothing"), Not(HasSubstr("one point")))));
}

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;

/// Each view shares n - distance points with the view at that distance.
void AddPoints(Scene* scene) {
  const int n = static_cast<int>(scene->views.size());
  for (int a = 0; a < n; ++a) {
    for (int b = a + 1; b < n; ++b) {
      ScenePoint point;
      point.xyz.setZero();
      point.views = {a, b};
      for (int i = 0; i < n - (b - a); ++i) scene->points.push_back(point);
    }
  }
}

TEST(NeighborsByPoints, TakesThreeOfEachView) {
  Scene scene;
  scene.views.resize(8);
  AddPoints(&scene);
  const auto pairs = NeighborsByPoints(scene, {0, 1, 2, 3, 4, 5, 6, 7});
  EXPECT_THAT(pairs, testing::AllOf(testing::Contains(Pair(0, 3)), testing::Contains(Pair(3, 4)),
                                    testing::Not(testing::Contains(Pair(0, 4)))));
  EXPECT_LE(pairs.size(), 24u);
  EXPECT_THAT(NeighborsByPoints(scene, {6, 2}), ElementsAre(Pair(0, 1))) << "positions among the views";
  EXPECT_THAT(NeighborsByPoints(Scene(), {}), IsEmpty());
}

TEST(MatchForCheck, LeavesMatchesThatFitOrNot) {
  const TempDir dir;
  Scene scene = WriteTexturedPlanes(dir / "scene", 4);
  AddPoints(&scene);
  EventRecorder events;
  MatchForCheck(scene, AllViews(scene), dir / "check", events.AsListener());
  const auto fit = FitPosesOf(scene, AllViews(scene), {0, 0, 0}, dir / "check", events.AsListener());
  ASSERT_TRUE(fit.has_value());
  EXPECT_EQ(fit->verdict, PoseVerdict::kFit);
  EXPECT_GT(fit->all.matches, 200);
  EXPECT_GE(fit->all.pairs, 3);

  // Again: colmap does not run.
  const std::string log = ReadFile(dir / "check" / "colmap.log");
  MatchForCheck(scene, AllViews(scene), dir / "check", events.AsListener());
  EXPECT_EQ(ReadFile(dir / "check" / "colmap.log"), log);
  EXPECT_THAT(events.warnings, IsEmpty());

  std::swap(scene.views[0].cam_from_world, scene.views[3].cam_from_world);
  std::swap(scene.views[1].cam_from_world, scene.views[2].cam_from_world);
  const auto wrong = FitPosesOf(scene, AllViews(scene), {0, 0, 0}, dir / "check", events.AsListener());
  ASSERT_TRUE(wrong.has_value());
  EXPECT_EQ(wrong->verdict, PoseVerdict::kHopeless);
  EXPECT_TRUE(wrong->IsExplained());
}

TEST(MatchForCheck, NotesThatColmapIsMissing) {
  const TempDir dir;
  const Scene scene = WriteTexturedPlanes(dir / "scene", 2);
  EventRecorder events;
  const std::string path = std::getenv("PATH");
  setenv("PATH", "/nowhere", 1);
  MatchForCheck(scene, AllViews(scene), dir / "check", events.AsListener());
  setenv("PATH", path.c_str(), 1);
  EXPECT_THAT(events.notes, ElementsAre(HasSubstr("the given poses are not checked")));
  EXPECT_THAT(events.warnings, IsEmpty());
}

}  // namespace

}  // namespace oraclegs
