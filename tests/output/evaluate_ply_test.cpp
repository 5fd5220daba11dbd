#include "oraclegs/output/evaluate_ply.h"

#include "run/trained.h"
#include "support/errors.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;

using EvaluatePlyTest = TrainedTest;

TEST_F(EvaluatePlyTest, ScoresAnyPlyTheSame) {
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

TEST_F(EvaluatePlyTest, KeepsMetricsOfAnotherProgram) {
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

}  // namespace
}  // namespace oraclegs
