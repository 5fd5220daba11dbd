#include "oraclegs/scene/point_views.h"

#include <gmock/gmock.h>

#include "support/event_recorder.h"

namespace oraclegs {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(FindViewsOfPoints, TakesTheViewsWhoseImageAPointFallsInto) {
  Scene scene;
  scene.views.resize(2);
  for (SceneView& view : scene.views) {
    view.intrinsics = {CameraModel::kPinhole, 6, 4, {5, 5, 3, 2}};
    view.cam_from_world = Eigen::Isometry3d::Identity();
  }
  scene.views[1].cam_from_world->translation().x() = 8;
  std::vector<ScenePoint> points(4);
  const double depths[] = {9, -9, 100, 9};
  for (size_t i = 0; i < points.size(); ++i) points[i].xyz = {0, 0, depths[i]};
  FindViewsOfPoints({0, 1, 2}, scene, &points);
  EXPECT_THAT(points[0].views, ElementsAre(0));
  EXPECT_THAT(points[1].views, IsEmpty());
  EXPECT_THAT(points[2].views, ElementsAre(0, 1));
  EXPECT_THAT(points[3].views, IsEmpty());
}

TEST(ReportUntracked, IsSilentWithoutAny) {
  EventRecorder events;
  ReportUntracked("F", 0, 5, events.AsListener());
  ReportPointsLeftOut("F", 0, 5, events.AsListener());
  EXPECT_THAT(events.notes, IsEmpty());
  EXPECT_THAT(events.warnings, IsEmpty());
  ReportUntracked("F", 2, 5, events.AsListener());
  ReportPointsLeftOut("F", 1, 5, events.AsListener());
  EXPECT_THAT(events.notes, ElementsAre(HasSubstr("F: 2 of 5 points have no track")));
  EXPECT_THAT(events.warnings, ElementsAre(HasSubstr("F: 1 of 5 points are left out")));
}

}  // namespace
}  // namespace oraclegs
