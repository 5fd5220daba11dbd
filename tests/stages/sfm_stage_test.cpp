#include "oraclegs/stages/stage_works.h"

#include "run/fixtures.h"
#include "support/event_recorder.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::IsEmpty;

class SfmStageTest : public testing::Test {
 protected:
  /// A run whose scene is a model with n points, each seen by all views.
  oraclegs::Run MakeRun(int n) {
    auto run = StartRun(request, recorder.AsListener());
    for (int i = 0; i < n; ++i) {
      ScenePoint point;
      point.xyz = {0.01 * i, 0, 0};
      for (size_t v = 0; v < run.scene.views.size(); ++v) point.views.push_back(static_cast<int>(v));
      run.scene.points.push_back(point);
    }
    return run;
  }

  TempDir temp;
  RunRequest request = TinyRequest(MakeTinyScene(temp / "scene"), temp / "out");
  EventRecorder recorder;
};

TEST_F(SfmStageTest, GivesTheModelsPoints) {
  request.options.start.init = {};
  request.options.start.sfm_points = SfmPoints::kModel;
  auto run = MakeRun(1000);
  EXPECT_EQ(Bring(&run, "sfm").points.size(), 1000u);
  EXPECT_EQ(run.workspace.Record("sfm").at("points"), 1000);
  EXPECT_GE(run.workspace.Record("sfm").at("seconds"), 0);
  EXPECT_TRUE(recorder.warnings.empty());
}

TEST_F(SfmStageTest, TakesTheModelByItselfWhereAllViewsTrain) {
  request.options.start.init = {};
  request.options.split.test_every = 0;
  auto run = MakeRun(1000);
  EXPECT_EQ(Bring(&run, "sfm").points.size(), 1000u);
}

TEST_F(SfmStageTest, TriangulatesWherePosedViewsLackTheirImages) {
  request.options.start.init = {};
  request.options.split.test_every = 0;
  auto run = MakeRun(1000);
  run.scene.missing_images.push_back("removed.jpg");  // which helped to place the model's points
  for (const ScenePoint& point : Bring(&run, "sfm").points) EXPECT_NE(point.xyz.y(), 0) << "a point of the model";
}

TEST_F(SfmStageTest, TriangulatesWhereViewsAreHeldOut) {
  request.options.start.init = {};
  auto run = MakeRun(1000);
  for (const ScenePoint& point : Bring(&run, "sfm").points) EXPECT_NE(point.xyz.y(), 0) << "a point of the model";
}

TEST_F(SfmStageTest, IsNotWantedWhereNothingUsesPoints) {
  request.options.train.depth_weight = 0;
  auto run = MakeRun(500);
  EXPECT_THAT(Bring(&run, "sfm").points, IsEmpty());
  EXPECT_TRUE(run.workspace.Record("sfm").is_null());
}

TEST_F(SfmStageTest, IsEmptyWhereNothingCanBeTriangulated) {
  request.options.start.init = StartKind::kSfm;
  auto run = MakeRun(0);
  run.split.train.resize(1);
  EXPECT_THAT(Bring(&run, "sfm").points, IsEmpty());
}

}  // namespace
}  // namespace oraclegs
