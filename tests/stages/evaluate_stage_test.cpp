#include "oraclegs/stages/evaluate_stage.h"

#include <gmock/gmock.h>

#include "oraclegs/core/files.h"
#include "oraclegs/gaussians/ply.h"
#include "oraclegs/output/evaluate_ply.h"
#include "oraclegs/stages/metrics.h"
#include "run/trained.h"
#include "support/errors.h"
#include "support/event_recorder.h"
#include "support/network_files.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {
using testing::HasSubstr;
using EvaluateStageTest = TrainedTest;

TEST_F(EvaluateStageTest, ScoresLpipsInBothConventions) {
  SKIP_WITHOUT_NETWORKS();
  EXPECT_FALSE(metrics->at("test").contains("lpips"));
  RunRequest with = *request;
  with.options.weights.lpips_weights = WriteTinyLpips(*temp / "lpips.safetensors");
  const nlohmann::json scored = Reconstruct(with, recorder.AsListener());
  EXPECT_THAT(recorder.started, testing::Contains("evaluate")) << "weights that came are a reason to score again";
  const nlohmann::json& test = scored.at("test");
  EXPECT_GT(test.at("lpips"), 0);
  EXPECT_GT(test.at("lpips_minus1_1"), 0);
  EXPECT_THAT(test.at("conventions").at("lpips").get<std::string>(), HasSubstr("[0, 1]"));
  EXPECT_THAT(test.at("conventions").at("lpips_minus1_1").get<std::string>(), HasSubstr("[-1, 1]"));
  for (const nlohmann::json& view : test.at("views")) EXPECT_TRUE(view.contains("lpips"));
  EXPECT_EQ(test.at("psnr"), metrics->at("test").at("psnr"));
  const PosedScene posed = ReadPosedScene(request->scene, request->options, Silent());
  const EvaluateRequest ply{*temp / "out" / "point_cloud.ply", with.options, {}, "test"};
  EXPECT_EQ(EvaluatePly(ply, posed, Silent()).at("test"), test);
  Reconstruct(*request, Silent());  // as the other tests expect it
}

TEST(ModelsBeside, ReadsWhatTrainingNamedOrWarns) {
  const TempDir dir;
  const WorkspacePaths paths(dir.path());
  Gaussians three = Gaussians::Zeros(3);
  for (int64_t i = 0; i < 3; ++i) three.quats[4 * i] = 1;
  WriteGaussianPly(dir / "0.ply", three);
  EventRecorder events;
  EXPECT_EQ(ModelsBeside(paths, {{"others", {"0.ply"}}}, kCpu, events.AsListener()).value().at(0).size(), 3);
  EXPECT_TRUE(ModelsBeside(paths, {{"others", nlohmann::json::array()}}, kCpu, events.AsListener()).value().empty());
  EXPECT_FALSE(ModelsBeside(paths, nlohmann::json::object(), kCpu, events.AsListener())) << "of an older version";
  EXPECT_TRUE(events.warnings.empty());
  WriteFileAtomically(dir / "1.ply", ReadFile(dir / "0.ply").substr(0, 400));
  EXPECT_FALSE(ModelsBeside(paths, {{"others", {"0.ply", "1.ply"}}}, kCpu, events.AsListener()));
  ASSERT_EQ(events.warnings.size(), 1u);
  EXPECT_THAT(events.warnings[0], testing::HasSubstr((dir / "1.ply").string()));
}

TEST_F(EvaluateStageTest, NeedsAModel) {
  RunRequest untrained = TinyRequest(request->scene, *temp / "untrained");
  auto run = StartRun(untrained, Silent());
  EXPECT_THAT(MessageOf<InputError>([&] { EvaluateRun(&run); }), HasSubstr("point_cloud.ply"));
}

TEST_F(EvaluateStageTest, ScoresAPointCloudThatWasReplaced) {
  RunRequest replaced = *request;
  replaced.out = *temp / "replaced";
  std::filesystem::copy(*temp / "out", replaced.out, std::filesystem::copy_options::recursive);
  auto run = OpenRun(replaced, recorder.AsListener());
  EvaluateRun(&run);
  EXPECT_THAT(recorder.started, testing::IsEmpty()) << "nothing has changed";
  GaussianPly ply = ReadGaussianPly(run.workspace.point_cloud());
  for (float& logit : ply.gaussians.opacity_logits.span()) logit -= 1;
  WriteGaussianPly(run.workspace.point_cloud(), ply.gaussians);
  EvaluateRun(&run);
  EXPECT_THAT(recorder.started, testing::ElementsAre("evaluate"));
  EXPECT_NE(ReadMetrics(replaced.out).at("test"), metrics->at("test"));
}

using testing::Contains;

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
