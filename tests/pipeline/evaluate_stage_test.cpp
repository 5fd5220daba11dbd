#include "oraclegs/pipeline/evaluate_stage.h"

#include "pipeline/trained.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;

using EvaluateStageTest = TrainedTest;

TEST_F(EvaluateStageTest, EvaluatesAnyPlyTheSame) {
  const auto ply = *temp / "out" / "point_cloud.ply";
  const PosedScene posed = ReadPosedScene(request->scene, request->options, Silent());
  const auto scores = EvaluatePly({ply, request->options, *temp / "scores"}, posed, Silent());
  EXPECT_EQ(scores.at("test"), metrics->at("test"));
  EXPECT_EQ(nlohmann::json::parse(ReadFile(*temp / "scores" / "metrics.json")), scores);
  EXPECT_TRUE(std::filesystem::exists(*temp / "scores" / "renders" / "test"));
  EXPECT_THROW(EvaluatePly({ply, request->options, *temp / "out"}, posed, Silent()), InputError);
  EXPECT_THROW(EvaluatePly({ply, request->options, request->scene / "x"}, posed, Silent()), InputError);
  EXPECT_THROW(EvaluatePly({*temp / "none.ply", request->options, {}}, posed, Silent()), InputError);
}

TEST_F(EvaluateStageTest, EvaluateNeedsAModel) {
  RunRequest untrained = TinyRequest(request->scene, *temp / "untrained");
  auto run = StartRun(untrained, Silent());
  EXPECT_THAT(MessageOf<InputError>([&] { RunEvaluate(&run); }), HasSubstr("point_cloud.ply"));
}

}  // namespace
}  // namespace oraclegs
