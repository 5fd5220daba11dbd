#include "oraclegs/pipeline/stages/evaluate_stage.h"

#include "pipeline/trained.h"
#include "support/network_files.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;

using EvaluateStageTest = TrainedTest;

TEST_F(EvaluateStageTest, EvaluatesAnyPlyTheSame) {
  const auto ply = *temp / "out" / "point_cloud.ply";
  const PosedScene posed = ReadPosedScene(request->scene, request->options, Silent());
  const auto scores = EvaluatePly({ply, request->options, *temp / "scores", "test"}, posed, Silent());
  EXPECT_EQ(scores.at("test"), metrics->at("test"));
  EXPECT_EQ(nlohmann::json::parse(ReadFile(*temp / "scores" / "metrics.json")), scores);
  EXPECT_TRUE(std::filesystem::exists(*temp / "scores" / "renders" / "test"));
  EXPECT_EQ(scores.at("program"), "oraclegs");
  EXPECT_EQ(scores.at("version"), "test");
  EXPECT_EQ(scores.at("seed"), 0);
  EXPECT_EQ(scores.at("views").at("test"), 2);
  EXPECT_THROW(EvaluatePly({ply, request->options, *temp / "out", ""}, posed, Silent()), InputError);
  EXPECT_THROW(EvaluatePly({ply, request->options, request->scene / "x", ""}, posed, Silent()), InputError);
  EXPECT_THROW(EvaluatePly({*temp / "none.ply", request->options, {}, ""}, posed, Silent()), InputError);
}

TEST_F(EvaluateStageTest, MetricsOfAnotherProgramAreNotOverwritten) {
  const PosedScene posed = ReadPosedScene(request->scene, request->options, Silent());
  const EvaluateRequest evaluate{*temp / "out" / "point_cloud.ply", request->options, *temp / "theirs", "test"};
  const auto file = *temp / "theirs" / "metrics.json";
  std::filesystem::create_directories(file.parent_path());
  for (const char* text : {"{\"accuracy\": 0.9}", "[1, 2]", "not json", "{\"program\": \"other\"}"}) {
    WriteText(file, text);
    EXPECT_THAT(MessageOf<InputError>([&] { EvaluatePly(evaluate, posed, Silent()); }), HasSubstr(file.string()));
    EXPECT_EQ(ReadFile(file), text);
    EXPECT_FALSE(std::filesystem::exists(*temp / "theirs" / "renders"));
  }
  WriteText(file, "{\"test\": {}, \"gaussians\": 3}");  // an earlier version's
  EvaluatePly(evaluate, posed, Silent());
  EXPECT_EQ(EvaluatePly(evaluate, posed, Silent()).at("test"), metrics->at("test"));  // and its own
}

TEST_F(EvaluateStageTest, LpipsIsScoredInBothConventionsWhereThereAreWeights) {
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

TEST_F(EvaluateStageTest, EvaluateNeedsAModel) {
  RunRequest untrained = TinyRequest(request->scene, *temp / "untrained");
  auto run = StartRun(untrained, Silent());
  EXPECT_THAT(MessageOf<InputError>([&] { RunEvaluate(&run); }), HasSubstr("point_cloud.ply"));
}

}  // namespace
}  // namespace oraclegs
