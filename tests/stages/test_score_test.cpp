#include "oraclegs/stages/test_score.h"

#include "oraclegs/stages/evaluate_stage.h"
#include "run/trained.h"

namespace oraclegs {
namespace {

using testing::Contains;
using testing::HasSubstr;

using TestScoreTest = TrainedTest;

TEST_F(TestScoreTest, IsThatOfMetricsJson) {
  oraclegs::Run run = OpenRun(*request, Silent());
  EXPECT_FALSE(TestScoreOf(run).IsDue(10, 10));
  run.options.checkpoints.eval_every = 10;
  const TestScore score = TestScoreOf(run);
  EXPECT_TRUE(score.IsDue(20, 25) && score.IsDue(25, 25));
  EXPECT_FALSE(score.IsDue(0, 25) || score.IsDue(21, 25));
  const Gaussians gaussians = LoadModel(run.workspace.point_cloud(), run.options, kCpu, run.frame).gaussians;
  EXPECT_DOUBLE_EQ(score.psnr(gaussians), metrics->at("test").at("psnr").get<double>());
}

TEST_F(TestScoreTest, NeedsTestViews) {
  oraclegs::Run run = OpenRun(*request, recorder.AsListener());
  run.options.checkpoints.eval_every = 10;
  run.split.test.clear();
  EXPECT_EQ(TestScoreOf(run).every, 0);
  EXPECT_THAT(recorder.warnings, Contains(HasSubstr("--eval-every: there are no test views")));
}

}  // namespace
}  // namespace oraclegs
