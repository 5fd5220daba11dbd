#include "oraclegs/stages/stereo_of_run.h"

#include "run/fixtures.h"
#include "support/event_recorder.h"
#include "support/temp_dir.h"
#include "support/textured_planes.h"

namespace oraclegs {
namespace {

TEST(StereoOfRun, CountsViewsAsTheTrainingViewsDo) {
  const TempDir temp;
  auto run = StartRun(TinyRequest(MakeTinyScene(temp / "scene"), temp / "out"), Silent());
  ScenePoint point;
  point.views = {0, 1, 2, 4};  // 0 and 3 test
  GivePoints(&run, {point});
  ASSERT_EQ(run.split.train, (std::vector<int>{1, 2, 4, 5}));
  EXPECT_EQ(SeenByTrainingViews(run)[0].views, (std::vector<int>{0, 1, 2}));
}

TEST(StereoOfRun, ReportsStepsOfTheStageThatAsks) {
  const TempDir temp;
  EventRecorder recorder;
  RunRequest request = TinyRequest(MakeTinyScene(temp / "scene"), temp / "out");
  request.options.stereo.iterations = 1;
  auto run = StartRun(request, recorder.AsListener());
  recorder.steps.clear();
  EXPECT_EQ(StereoOf(run, ViewsOf(&run).views, "poses").size(), 4u);
  size_t steps = 0;
  for (const StepDone& step : recorder.steps) steps += step.stage == "poses" ? 1 : 0;
  EXPECT_GE(steps, 4u);
}

TEST(ConfirmedDepth, IsLostByAMisplacedView) {
  const TempDir dir;
  const Scene scene = WriteTexturedPlanes(dir.path(), 4);
  const std::vector<double> right = ConfirmedDepth(scene, kCpu);
  ASSERT_EQ(right.size(), 4u);
  for (const double share : right) EXPECT_GT(share, .3);

  Scene wrong = scene;
  wrong.views[1].cam_from_world->prerotate(Eigen::AngleAxisd(.2, Eigen::Vector3d::UnitX()));
  const std::vector<double> shares = ConfirmedDepth(wrong, kCpu);
  EXPECT_LT(shares[1], .05);
  for (const size_t view : {0u, 2u, 3u}) EXPECT_GT(shares[view], .2) << view;

  Scene far = scene;  // the unit of a model is open
  for (SceneView& view : far.views) view.cam_from_world->translation() *= 128;
  EXPECT_NEAR(ConfirmedDepth(far, kCpu)[0], right[0], 1e-6);
}

}  // namespace
}  // namespace oraclegs
