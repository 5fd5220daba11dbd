#include "oraclegs/pipeline/start_points.h"

#include "pipeline/fixtures.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;

class StartPointsTest : public testing::Test {
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
  Recorder recorder;
};

TEST_F(StartPointsTest, RandomIsWhatWasAskedForAndRemembered) {
  auto run = MakeRun(500);
  const StartPoints start = RunSfm(&run);
  EXPECT_EQ(start.source, "random");
  EXPECT_EQ(start.cloud.xyz.size(), 400u);
  EXPECT_EQ(run.workspace.Record("sfm").at("source"), "random");
  EXPECT_EQ(run.workspace.Record("sfm").at("points"), 400);
  EXPECT_TRUE(recorder.warnings.empty());
}

TEST_F(StartPointsTest, UsesAModelsPointsAndAtMostSoManyAsGaussians) {
  request.options.start.init = "auto";
  auto run = MakeRun(1000);
  const StartPoints start = RunSfm(&run);
  EXPECT_EQ(start.source, "sfm");
  ASSERT_EQ(start.cloud.xyz.size(), 500u);
  EXPECT_FLOAT_EQ(start.cloud.xyz[1].x(), 0.02f);  // every second one
  EXPECT_FLOAT_EQ(start.cloud.xyz[499].x(), 9.98f);
}

TEST_F(StartPointsTest, FewPointsAreJoinedByRandomOnesUpToTheBudget) {
  request.options.start.init = "auto";
  auto run = MakeRun(150);
  const StartPoints start = RunSfm(&run);
  EXPECT_EQ(start.source, "sfm+random");
  ASSERT_EQ(start.cloud.xyz.size(), 500u);  // 400 random points were asked for, the budget is 500
  EXPECT_EQ(start.cloud.rgb.size(), 500u);
  EXPECT_FLOAT_EQ(start.cloud.xyz[149].x(), 1.49f);
}

TEST_F(StartPointsTest, TooFewPointsFallBackWithAWarning) {
  request.options.start.init = "auto";
  auto run = MakeRun(0);
  run.split.train.resize(2);
  run.split.train[1] = run.split.train[0];  // nothing to triangulate from
  const StartPoints start = RunSfm(&run);
  EXPECT_EQ(start.source, "random");
  ASSERT_FALSE(recorder.warnings.empty());
  EXPECT_THAT(recorder.warnings.back(), HasSubstr("fewer than 100"));
}

TEST_F(StartPointsTest, InsistingOnPointsThatAreNotThereIsRefused) {
  request.options.start.init = "sfm";
  auto run = MakeRun(0);
  run.split.train.resize(1);
  EXPECT_THAT(MessageOf<InputError>([&] { RunSfm(&run); }), HasSubstr("--init random"));
}

}  // namespace
}  // namespace oraclegs
