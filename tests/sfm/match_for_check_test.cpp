#include "oraclegs/sfm/match_for_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <utility>

#include "oraclegs/core/files.h"
#include "oraclegs/sfm/pose_fit.h"
#include "support/event_recorder.h"
#include "support/temp_dir.h"
#include "support/textured_planes.h"

namespace oraclegs {
namespace {

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
