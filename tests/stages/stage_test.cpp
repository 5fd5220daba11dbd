#include "oraclegs/stages/stage.h"

#include <gtest/gtest.h>

#include "run/fixtures.h"
#include "support/event_recorder.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

TEST(ViewsOf, LoadsTheTrainingViewsOnce) {
  const TempDir temp;
  auto run = StartRun(TinyRequest(MakeTinyScene(temp / "scene"), temp / "out"), Silent());
  EventRecorder recorder;
  run.listener = recorder.AsListener();
  const TrainingViews& training = ViewsOf(&run);
  ASSERT_EQ(training.views.size(), run.split.train.size());
  EXPECT_EQ(training.views[1].name, run.scene.views[static_cast<size_t>(run.split.train[1])].name);
  const size_t steps = recorder.steps.size();
  EXPECT_GT(steps, 0u);
  EXPECT_EQ(&ViewsOf(&run), &training);
  EXPECT_EQ(recorder.steps.size(), steps);
}

TEST(LargerViews, AreReadWhereTheWorkingSizeHasTooFewPixels) {
  const TempDir temp;
  RunRequest request = TinyRequest(MakeTinyScene(temp / "scene"), temp / "out");
  request.options.image.downscale = 2;
  auto run = StartRun(request, Silent());
  EXPECT_FALSE(LargerViews(run, 18)) << "24 x 18 suffice";
  const auto larger = LargerViews(run, 30);
  ASSERT_TRUE(larger);
  ASSERT_EQ(larger->size(), run.split.train.size());
  EXPECT_EQ(larger->front().rgb.width, 48);
  EXPECT_EQ(larger->front().camera.height, 36);
  EXPECT_EQ(larger->front().name, ViewsOf(&run).views.front().name);
  run.plan.image.downscale = 1;
  EXPECT_FALSE(LargerViews(run, 100)) << "the files have no more";
}

TEST(Geometry, FreesColorsOfExposuresThatVary) {
  Geometry geometry;
  EXPECT_FALSE(geometry.HasVariedExposure());
  geometry.gains.assign(4, Eigen::Vector3f::Ones());
  EXPECT_FALSE(geometry.HasVariedExposure());
  EXPECT_TRUE(FusionOf(geometry.gains).gains.empty());
  geometry.gains[1] = Eigen::Vector3f::Constant(1.5f);
  EXPECT_TRUE(geometry.HasVariedExposure());
  EXPECT_EQ(FusionOf(geometry.gains).gains.size(), 4u);
}

}  // namespace
}  // namespace oraclegs
