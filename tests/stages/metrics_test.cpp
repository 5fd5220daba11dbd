#include "oraclegs/stages/metrics.h"

#include "oraclegs/image/codecs.h"
#include "oraclegs/propose/proposal_files.h"
#include "oraclegs/run/reconstruct.h"
#include "oraclegs/run/stages.h"
#include "oraclegs/scene/loaded_view.h"
#include "oraclegs/stages/stage_works.h"
#include "oraclegs/workspace/stage_records.h"
#include "run/fixtures.h"
#include "run/proposing.h"
#include "run/trained.h"
#include "support/errors.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

TEST(MetricsToJson, HasTheKeysThatOthersRelyOn) {
  const TempDir temp;
  auto run = StartRun(TinyRequest(MakeTinyScene(temp / "scene"), temp / "out"), Silent());
  run.workspace.MarkDone(
      "sfm",
      {{"key", "a"}, {"seconds", 3}, {"cpu_seconds", 5}, {"points", 400}, {"poses", {{"warning", "poses are off"}}}});
  run.workspace.MarkDone("validate", {{"key", "v"},
                                      {"seconds", 1},
                                      {"oracle", "vggt"},
                                      {"mean_confidence", {{"a", 0.5}, {"b", 1}}},
                                      {"non_commercial", {"VGGT-1B"}}});
  run.workspace.MarkDone("depth", {{"key", "c"},
                                   {"warning", "little depth"},
                                   {"seconds", 4},
                                   {"points", 9000},
                                   {"prior", "fused"},
                                   {"right", 0.7},
                                   {"network", "a"}});
  run.workspace.MarkDone("start", {{"key", ""}, {"seconds", 0}, {"source", "dense"}, {"points", 500}});
  run.workspace.MarkDone("train", {{"key", "b"},
                                   {"seconds", 12},
                                   {"training_seconds", 10},
                                   {"iterations", 50},
                                   {"chosen", {{"rate-scale", 3.5}}},
                                   {"lpips", "VGG16"},
                                   {"peak_memory_bytes", int64_t{1} << 50}});
  const nlohmann::json test = {{"psnr", 20.5}, {"ssim", 0.7}, {"views", nlohmann::json::array()}};
  const nlohmann::json metrics =
      MetricsToJson(run, {{"test", test}, {"gaussians", 500}, {"seconds", 1.5}, {"peak_memory_bytes", 7}});
  EXPECT_EQ(metrics.at("test"), test);
  EXPECT_EQ(metrics.at("gaussians"), 500);
  EXPECT_EQ(metrics.at("stages").at("sfm").at("seconds"), 3);
  EXPECT_EQ(metrics.at("stages").at("sfm").at("cpu_seconds"), 5);
  EXPECT_FALSE(metrics.at("stages").at("depth").contains("cpu_seconds"));
  EXPECT_EQ(metrics.at("stages").at("depth").at("seconds"), 4);
  EXPECT_EQ(metrics.at("stages").at("train").at("seconds"), 12);
  EXPECT_EQ(metrics.at("stages").at("evaluate").at("seconds"), 1.5);
  EXPECT_FALSE(metrics.at("stages").contains("register"));
  EXPECT_EQ(metrics.at("train").at("iterations"), 50);
  EXPECT_EQ(metrics.at("train").at("iterations_per_second"), 5);
  EXPECT_EQ(metrics.at("train").at("lpips"), "VGG16");
  EXPECT_EQ(metrics.at("train").at("chosen").at("rate-scale"), 3.5);
  EXPECT_EQ(metrics.at("depth").at("prior"), "fused");
  EXPECT_EQ(metrics.at("depth").at("right"), 0.7);
  EXPECT_EQ(metrics.at("depth").at("network"), "a");
  EXPECT_EQ(metrics.at("proposals").at("oracle"), "vggt");
  EXPECT_EQ(metrics.at("proposals").at("count"), 2);
  EXPECT_EQ(metrics.at("proposals").at("mean_confidence"), 0.75);
  EXPECT_EQ(metrics.at("peak_memory_bytes"), int64_t{1} << 50);
  EXPECT_EQ(metrics.at("warnings"), nlohmann::json({"poses are off", "little depth"}));
  EXPECT_EQ(metrics.at("non_commercial"), nlohmann::json({"VGGT-1B"}));
  EXPECT_EQ(metrics.at("program"), "oraclegs");
  EXPECT_EQ(metrics.at("version"), "test");
  EXPECT_EQ(metrics.at("seed"), 0);
  EXPECT_EQ(metrics.at("options").at("iterations"), 30);
  EXPECT_EQ(metrics.at("start").at("source"), "dense");
  EXPECT_EQ(metrics.at("start").at("points"), 500);
  EXPECT_EQ(metrics.at("views").at("train"), 4);
}

TEST(CpuSeconds, GrowWithWork) {
  const double before = CpuSeconds();
  EXPECT_GT(before, 0);
  volatile double sum = 0;
  while (CpuSeconds() < before + 0.05) sum = sum + 1;
  EXPECT_GE(CpuSeconds(), before + 0.05);
}

TEST(ReadMetrics, NamesADamagedFile) {
  const TempDir temp;
  EXPECT_THROW(ReadMetrics(temp.path()), InputError);
  WriteText(temp / "metrics.json", "{\"test\":");
  EXPECT_THAT(MessageOf<InputError>([&] { ReadMetrics(temp.path()); }), testing::HasSubstr("metrics.json"));
}

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

json Records() {
  return {{"register", {{"seconds", 61.2}, {"photos", 12}, {"registered", 11}}},
          {"sfm", {{"seconds", 12}, {"points", 3021}}},
          {"depth", {{"seconds", 62}, {"points", 41230}, {"confident_share", 0.78}}},
          {"proxies", {{"seconds", 70}, {"models", 4}}},
          {"propose", {{"seconds", 60}, {"targets", 32}, {"folder", 0}}},
          {"validate", {{"seconds", 40}, {"mean_confidence", {{"a", 0.5}, {"b", 0.7}}}}},
          {"start", {{"seconds", 0}, {"points", 400}}},
          {"train", {{"seconds", 3700}, {"gaussians", 98123}, {"iterations", 7000}}},
          {"evaluate", {{"seconds", 1.2}, {"test", {{"psnr", 27.014}, {"ssim", 0.91234}}}}}};
}

TEST(StageTable, SaysOfEachStageWhatItTookAndGave) {
  EXPECT_EQ(StageTable(Stages(), json::object(), Records()),
            "stage        time  result\n"
            "register     1:01  11 of 12 photos\n"
            "sfm          0:12  3021 points\n"
            "depth        1:02  confident on 78 % of the pixels, 41230 dense points\n"
            "proxies      1:10  4 proxy models\n"
            "propose      1:00  32 views\n"
            "validate     0:40  2 proposals, mean confidence 0.60\n"
            "train     1:01:40  98123 Gaussians, 7000 iterations\n"
            "evaluate     0:01  PSNR 27.01 dB, SSIM 0.9123\n"
            "total     1:06:46\n");
}

TEST(StageTable, HasWhatWasPredicted) {
  json records = {{"sfm", {{"seconds", 12}, {"points", 3021}, {"predicted_seconds", 15}}},
                  {"train", {{"seconds", 100}, {"gaussians", 5}, {"iterations", 7}, {"predicted_seconds", 90}}}};
  EXPECT_EQ(StageTable(Stages(), json::object(), records),
            "stage  time  predicted  result\n"
            "sfm    0:12       0:15  3021 points\n"
            "train  1:40       1:30  5 Gaussians, 7 iterations\n"
            "total  1:52       1:45\n");
  records["sfm"].erase("predicted_seconds");  // of an earlier version
  EXPECT_THAT(StageTable(Stages(), json::object(), records), HasSubstr("total  1:52\n"));
}

TEST(StageTable, SaysWhatThisRunTook) {
  json before = Records();
  before.erase("evaluate");
  EXPECT_THAT(StageTable(Stages(), before, Records()), HasSubstr("total     1:06:46  0:01 in this run\n"));
}

TEST(StageTable, MarksWhatStoodThereBefore) {
  json before = Records();
  before["train"]["seconds"] = 3;
  before.erase("evaluate");
  const std::string table = StageTable(Stages(), before, Records());
  EXPECT_THAT(table, HasSubstr("41230 dense points (unchanged)\n"));
  EXPECT_THAT(table, HasSubstr("7000 iterations\n"));
  EXPECT_THAT(table, HasSubstr("SSIM 0.9123\n"));
}

TEST(StageTable, ReadsDamagedRecords) {
  json records = Records();
  records["sfm"] = "damaged";
  records["validate"]["mean_confidence"] = {{"a", nullptr}, {"b", 0.5}};
  const std::string table = StageTable(Stages(), {}, records);
  EXPECT_THAT(table, Not(HasSubstr("sfm")));
  EXPECT_THAT(table, HasSubstr("2 proposals"));
}

TEST(StageTable, PassesOverWhatARunDidNotNeed) {
  json records = Records();
  records["propose"]["folder"] = 3;
  EXPECT_THAT(StageTable(Stages(), {}, records), HasSubstr("32 views, 3 from the folder"));
  records.erase("propose");
  EXPECT_THAT(StageTable(Stages(), {}, records), Not(HasSubstr("propose")));
  records["propose"] = {{"seconds", 1}, {"targets", 0}};  // no usable pose
  records.erase("validate");
  EXPECT_THAT(StageTable(Stages(), {}, records), HasSubstr("0 views"));
  records["evaluate"]["test"]["psnr"] = nullptr;
  EXPECT_THAT(StageTable(Stages(), {}, records), HasSubstr("no test pixels"));
}

using StageTableOfARun = TrainedTest;

TEST_F(StageTableOfARun, KnowsWhatASecondCallDidNotRepeat) {
  const json before = ReadStageRecords(request->out);
  EXPECT_THAT(StageTable(Stages(), {}, before), Not(HasSubstr("unchanged")));
  Reconstruct(*request, Silent());
  const std::string table = StageTable(Stages(), before, ReadStageRecords(request->out));
  EXPECT_THAT(table, HasSubstr("30 iterations (unchanged)"));
  EXPECT_THAT(table, HasSubstr(fmt::format("PSNR {:.2f} dB", metrics->at("test").at("psnr").get<double>())));
}

namespace fs = std::filesystem;
using testing::AllOf;
using OracleReportTest = ProposingTest;

TEST_F(OracleReportTest, MeasuresProposalsAgainstSpareViews) {
  auto run = StartRun(Request(), Silent());
  // A proposal that is the image itself but for one row, which the oracle does not trust.
  const int v = SpareViews(run)[1];
  const std::string file = FileName(run.scene.views[static_cast<size_t>(v)].name) + ".png";
  Image8 picture = ToImage8(LoadViews(run.scene, {v}, run.plan.image, Silent())[0].rgb);
  std::vector<uint8_t> trust(size_t{80} * 60, 255);
  for (size_t x = 0; x < 80; ++x) {
    for (size_t c = 0; c < 3; ++c) picture.data[3 * x + c] = static_cast<uint8_t>(picture.data[3 * x + c] ^ 0x80);
    trust[x] = 20;
  }
  WritePng(run.workspace.proposals() / file, picture);
  WritePng(run.workspace.confidence() / file, Image8{80, 60, 1, trust});
  EXPECT_THROW(ReportOracle(run), InputError);  // there is no record of what these are
  const std::string stem = file.substr(0, file.size() - 4);
  run.workspace.MarkDone("validate",
                         {{"key", ""}, {"mean_confidence", {{stem, 0.9}}}, {"files", {"confidence/" + file}}});
  const nlohmann::json report = ReportOracle(run);
  EXPECT_EQ(report.at("views"), 1);
  EXPECT_EQ(report.at("oracle").at("pixels"), 80 * 60);
  // The color correction spreads a little of the row's error over the others, in no order that the confidence knows.
  EXPECT_LT(report.at("oracle").at("ause_ratio").get<double>(), 0.6);
  EXPECT_EQ(report.at("oracle").at("auroc_large_error"), 1);
  // 7 rows of 10 blocks, and 4 rows of pixels that are half a block; the top ones have an RMS error of .5 / sqrt(8).
  EXPECT_EQ(report.at("oracle").at("blocks").at("blocks"), 80);
  EXPECT_EQ(report.at("oracle").at("blocks").at("auroc_large_error"), 1);
  EXPECT_EQ(report.at("uniform").at("blocks").at("auroc_large_error"), 0.5);
  EXPECT_NEAR(report.at("uniform").at("ause_ratio").get<double>(), 1, 1e-6);
  EXPECT_NEAR(report.at("psnr").get<double>(), -10 * std::log10(128. * 128 / 255 / 255 / 60), 0.2);
  EXPECT_TRUE(fs::exists(run.workspace.root() / "oracle.json"));
  for (uint8_t& color : picture.data) color = static_cast<uint8_t>(color * 0.8);
  WritePng(run.workspace.proposals() / file, picture);
  const nlohmann::json darker = ReportOracle(run);
  EXPECT_LT(darker.at("psnr"), report.at("psnr"));
  EXPECT_NEAR(darker.at("oracle").at("mean_error").get<double>(), report.at("oracle").at("mean_error").get<double>(),
              0.02);
}

TEST_F(OracleReportTest, SaysWhatIsNeeded) {
  auto run = StartRun(Request("nothing"), Silent());
  EXPECT_THAT(MessageOf<InputError>([&] { ReportOracle(run); }),
              AllOf(HasSubstr("holds no validated proposals"), HasSubstr("--trajectory dataset")));
  run.workspace.MarkDone("validate",
                         {{"key", ""}, {"mean_confidence", {{"orbit_0000", 0.9}}}, {"files", {"split.json"}}});
  EXPECT_THAT(MessageOf<InputError>([&] { ReportOracle(run); }),
              AllOf(HasSubstr("no proposal has the pose of a view"), HasSubstr("--trajectory dataset")));
}

}  // namespace
}  // namespace oraclegs
