#include "oraclegs/stages/stage_table.h"

#include "oraclegs/run/reconstruct.h"
#include "oraclegs/run/stages.h"
#include "oraclegs/workspace/stage_records.h"
#include "run/trained.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

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

}  // namespace
}  // namespace oraclegs
