#include "oraclegs/stages/stereo_of_run.h"

#include "run/fixtures.h"
#include "support/event_recorder.h"
#include "support/temp_dir.h"

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

}  // namespace
}  // namespace oraclegs
