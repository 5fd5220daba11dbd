#include "oraclegs/output/report/run_document.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "oraclegs/web/assets.h"
#include "run/trained.h"

namespace oraclegs {
namespace {

using ReportStageTest = TrainedTest;

TEST_F(ReportStageTest, WritesOneFileThatNeedsNoOther) {
  const std::filesystem::path page = *temp / "out/report.html";
  ASSERT_EQ(std::filesystem::exists(page), WebPagesBuilt());
  if (!WebPagesBuilt()) return;
  const std::string html = ReadFile(page);
  EXPECT_THAT(html, testing::HasSubstr("data:image/jpeg;base64,"));
  EXPECT_THAT(html, testing::Not(testing::HasSubstr("\"url\":\"report/")));
}

TEST_F(ReportStageTest, IsMadeAgainWhenTheScoresAreOthers) {
  RunRequest copy = *request;
  copy.out = *temp / "copy";
  std::filesystem::copy(*temp / "out", copy.out, std::filesystem::copy_options::recursive);
  EventRecorder first, second;
  Reconstruct(copy, first.AsListener());
  EXPECT_THAT(first.started, testing::Not(testing::Contains("report")));
  nlohmann::json scores = nlohmann::json::parse(ReadFile(copy.out / "metrics.json"));
  scores["test"]["psnr"] = 99;
  WriteFileAtomically(copy.out / "metrics.json", scores.dump());
  Reconstruct(copy, second.AsListener());
  EXPECT_THAT(second.started, testing::ElementsAre("report"));
}

TEST_F(ReportStageTest, CanBeLeftOut) {
  RunRequest without = *request;
  without.out = *temp / "without";
  without.options.report.report = false;
  Reconstruct(without, Silent());
  EXPECT_FALSE(std::filesystem::exists(without.out / "report"));
  EXPECT_FALSE(std::filesystem::exists(without.out / "report.html"));
}

}  // namespace
}  // namespace oraclegs
