#include "oraclegs/experiments/ablation.h"

#include "oraclegs/core/interrupt.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/stages/metrics.h"
#include "oraclegs/workspace/stage_records.h"
#include "run/proposing.h"
#include "support/errors.h"
#include "support/network_files.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

class AblationTest : public ProposingTest {
 protected:
  static AblationRequest Ask(const std::string& out, const std::string& rows, int seeds = 1) {
    AblationRequest request{Request(out), {seeds, rows}, "oraclegs ablate scene -o out"};
    request.run.options.train.iterations = 10;
    return request;
  }
  nlohmann::json Saved(const std::string& out) const {
    return nlohmann::json::parse(ReadFile(temp->path() / out / "ablation.json"));
  }
};

TEST_F(AblationTest, TrainsEachRowInItsWorkspaceAndSharesStages) {
  const AblationRequest request = Ask("shared", "union,schedule");
  const Ablation ablation = RunAblation(request, recorder.AsListener());
  const fs::path out = request.run.out, first = out / "rows/02-union/seed-0", second = out / "rows/03-schedule/seed-0";
  ASSERT_EQ(ablation.rows.size(), 2u);
  EXPECT_EQ(*ablation.rows[0].runs[0].psnr, ReadMetrics(first).at("test").at("psnr"));
  EXPECT_EQ(*ablation.rows[1].runs[0].psnr, ReadMetrics(second).at("test").at("psnr"));
  EXPECT_EQ(ReadSavedRun(first).options.at("schedule"), "union");
  EXPECT_EQ(ReadSavedRun(second).options.at("schedule"), "paper");
  const nlohmann::json of_first = ReadStageRecords(first), of_second = ReadStageRecords(second);
  for (const char* stage : {"depth", "propose", "validate"}) {
    EXPECT_EQ(of_first.at(stage), of_second.at(stage)) << "made once: " << stage;
  }
  EXPECT_FALSE(fs::exists(first / "checkpoints"));
  EXPECT_EQ(ablation.train_views, 12u);
  EXPECT_EQ(ablation.width, 80);
  EXPECT_EQ(Saved("shared"), AblationToJson(ablation));
  EXPECT_EQ(ReadFile(out / "ablation.md"), AblationMarkdown(ablation));
  EXPECT_THAT(recorder.notes,
              Contains(AllOf(HasSubstr("row 2 of 11 (+ all proposals), seed 0: "), HasSubstr(" left"))));
  EXPECT_THAT(recorder.notes, Contains(AllOf(HasSubstr("row 3 of 11"), Not(HasSubstr(" left")))));

  // Given again, nothing is trained; a second seed takes the depth of the first.
  const auto written = fs::last_write_time(first / "point_cloud.ply");
  const Ablation both = RunAblation(Ask("shared", "union,schedule", 2), Silent());
  EXPECT_EQ(fs::last_write_time(first / "point_cloud.ply"), written);
  ASSERT_EQ(both.rows[0].runs.size(), 2u);
  EXPECT_EQ(both.rows[0].runs[0].psnr, ablation.rows[0].runs[0].psnr);
  EXPECT_EQ(ReadStageRecords(out / "rows/02-union/seed-1").at("depth"), of_first.at("depth"));
  EXPECT_NE(ReadStageRecords(out / "rows/02-union/seed-1").at("train").at("key"), of_first.at("train").at("key"));

  AblationRequest other = Ask("shared", "union");
  other.run.options.train.iterations = 11;
  EXPECT_THAT(MessageOf<InputError>([&] { RunAblation(other, Silent()); }),
              HasSubstr("--iterations was 10, now is 11"));
  other.run.overwrite = true;
  EXPECT_EQ(RunAblation(other, Silent()).rows.size(), 1u);
  EXPECT_EQ(ReadMetrics(first).at("train").at("iterations"), 11);
}

TEST_F(AblationTest, SeedsShareProposalsThatDoNotDependOnThem) {
  AblationRequest request = Ask("seeds", "union", 2);
  for (const bool is_seeded : {false, true}) {
    request.run.out = *temp / (is_seeded ? "seeded" : "common");
    request.run.options.trajectory.trajectory = is_seeded ? Trajectory::kCoverage : Trajectory::kOrbit;
    RunAblation(request, Silent());
    const fs::path rows = request.run.out / "rows/02-union";
    const nlohmann::json first = ReadStageRecords(rows / "seed-0"), second = ReadStageRecords(rows / "seed-1");
    EXPECT_EQ(first.at("propose") == second.at("propose"), !is_seeded) << "made once";
    EXPECT_NE(first.at("train").at("key"), second.at("train").at("key"));
  }
}

TEST_F(AblationTest, ContinuesWhenInterrupted) {
  const AblationRequest request = Ask("stopped", "mcmc,union");
  const Listener stop = [](const Event& event) {
    const auto* note = std::get_if<Note>(&event);
    if (note && note->text.rfind("row 1 of 11", 0) == 0) RequestInterrupt(true);
  };
  EXPECT_THROW(RunAblation(request, stop), Interrupted);
  RequestInterrupt(false);
  nlohmann::json rows = Saved("stopped").at("rows");
  EXPECT_EQ(rows.at(0).at("runs").size(), 1u);
  EXPECT_TRUE(rows.at(1).at("runs").empty());
  EXPECT_THAT(ReadFile(request.run.out / "ablation.md"), HasSubstr("| 2 + all proposals | not run yet |"));

  const auto written = fs::last_write_time(request.run.out / "rows/01-mcmc/seed-0/point_cloud.ply");
  RunAblation(request, Silent());
  EXPECT_EQ(fs::last_write_time(request.run.out / "rows/01-mcmc/seed-0/point_cloud.ply"), written);
  rows = Saved("stopped").at("rows");
  EXPECT_EQ(rows.at(1).at("runs").size(), 1u);
  EXPECT_FALSE(fs::exists(request.run.out / "rows/01-mcmc/seed-0/depth")) << "of no use there";
  EXPECT_TRUE(rows.at(1).at("gain").at("mean").is_number());
}

TEST_F(AblationTest, GoesOnAfterARowThatFails) {
  // Images of nothing give no points to start from.
  const fs::path scene = *temp / "blank";
  fs::copy(*temp / "scene", scene, fs::copy_options::recursive);
  for (const auto& entry : fs::directory_iterator(scene / "images")) {
    WritePng(entry.path(), {80, 60, 3, std::vector<uint8_t>(80 * 60 * 3, 90)});
  }
  AblationRequest request = Ask("failing", "mcmc,sfm");
  request.run.scene = scene;
  const Ablation ablation = RunAblation(request, recorder.AsListener());
  EXPECT_TRUE(ablation.rows[0].runs[0].psnr);
  EXPECT_THAT(ablation.rows[1].runs[0].failure, HasSubstr("too few to start from"));
  EXPECT_THAT(recorder.warnings, Contains(HasSubstr("row 5 (+ SfM start), seed 0 failed: ")));

  request.options.rows = "sfm";
  EXPECT_THAT(MessageOf<InputError>([&] { RunAblation(request, Silent()); }), HasSubstr("too few to start from"))
      << "with nothing scored there is no table to speak of";
}

TEST_F(AblationTest, LeavesOutRowsThatChangeNothing) {
  AblationRequest request = Ask("left_out", "regularizers,calibration");
  request.run.options.validate.oracle = OracleKind::kUniform;
  const Ablation ablation = RunAblation(request, recorder.AsListener());
  ASSERT_EQ(ablation.rows.size(), 1u);
  EXPECT_THAT(recorder.notes, Contains(HasSubstr("Row 10 (+ calibrated oracle) is left out")));
  EXPECT_THAT(ablation.notes, Contains(HasSubstr("Row 10 (+ calibrated oracle) is left out")));
}

TEST_F(AblationTest, HasARowForLpipsWhereThereAreWeights) {
  SKIP_WITHOUT_NETWORKS();
  AblationRequest request = Ask("lpips", "lpips");
  EXPECT_THAT(MessageOf<InputError>([&] { RunAblation(request, Silent()); }),
              AllOf(HasSubstr("--rows names lpips"), HasSubstr("`oraclegs models fetch lpips-vgg`")));
  request.run.options.weights.lpips_weights = WriteTinyLpips(*temp / "lpips.safetensors");
  request.run.options.train.synthetic_floor = 0.9;
  const Ablation ablation = RunAblation(request, recorder.AsListener());
  ASSERT_EQ(ablation.rows.size(), 1u);
  EXPECT_EQ(ablation.rows[0].number, 4u);
  const fs::path out = request.run.out / "rows/04-lpips/seed-0";
  EXPECT_EQ(ReadMetrics(out).at("train").at("lpips"), "VGG16, images in [0, 1]");
  EXPECT_TRUE(ReadMetrics(out).at("test").contains("lpips"));
}

TEST_F(AblationTest, RefusesBadFoldersAndOptions) {
  const auto refusal = [&](const AblationRequest& request) {
    return MessageOf<InputError>([&] { RunAblation(request, Silent()); });
  };
  fs::create_directories(*temp / "theirs");
  WriteText(*temp / "theirs" / "thesis.tex", "x");
  EXPECT_THAT(refusal(Ask("theirs", "")), AllOf(HasSubstr("theirs"), HasSubstr("holds no ablation")));
  fs::create_directories(*temp / "json");
  WriteText(*temp / "json" / "ablation.json", "{\"program\": \"other\"}");
  EXPECT_THAT(refusal(Ask("json", "")), AllOf(HasSubstr("ablation.json"), HasSubstr("not written by oraclegs")));
  EXPECT_THAT(refusal(Ask("scene/out", "")), HasSubstr("never written to"));
  AblationRequest missing = Ask("missing", "");
  missing.run.scene = *temp / "nowhere";
  EXPECT_THAT(refusal(missing), HasSubstr("nowhere"));
  EXPECT_FALSE(fs::exists(missing.run.out)) << "a scene that cannot be read leaves nothing behind";
  EXPECT_THROW(RunAblation(Ask("usage", "", 0), Silent()), UsageError);
  AblationRequest nothing = Ask("usage", "");
  nothing.run.options.propose.proposers = std::string("none");
  EXPECT_THROW(RunAblation(nothing, Silent()), UsageError);
  EXPECT_FALSE(fs::exists(nothing.run.out));
}

TEST(SecondsLeft, TakesTheMeanForRowsNotYetTimed) {
  EXPECT_EQ(SecondsLeft({0, 0}, {0, 1}), 0);
  EXPECT_EQ(SecondsLeft({10, 0, 20}, {0, 1, 1, 2}), 60);
  EXPECT_EQ(SecondsLeft({10, 20}, {}), 0);
}

}  // namespace
}  // namespace oraclegs
