#include "oraclegs/stages/oracle_report.h"

#include "oraclegs/image/codecs.h"
#include "oraclegs/propose/proposal_files.h"
#include "oraclegs/scene/loaded_view.h"
#include "oraclegs/stages/validate_stage.h"
#include "run/proposing.h"
#include "support/errors.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
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
  EXPECT_NEAR(report.at("oracle").at("ause").get<double>(), 0, 1e-6);
  EXPECT_EQ(report.at("oracle").at("auroc_large_error"), 1);
  // 7 rows of 10 blocks, and 4 rows of pixels that are half a block; the top ones have an RMS error of .5 / sqrt(8).
  EXPECT_EQ(report.at("oracle").at("blocks").at("blocks"), 80);
  EXPECT_EQ(report.at("oracle").at("blocks").at("auroc_large_error"), 1);
  EXPECT_EQ(report.at("uniform").at("blocks").at("auroc_large_error"), 0.5);
  EXPECT_NEAR(report.at("uniform").at("ause_ratio").get<double>(), 1, 1e-6);
  EXPECT_NEAR(report.at("psnr").get<double>(), -10 * std::log10(128. * 128 / 255 / 255 / 60), 0.2);
  EXPECT_TRUE(fs::exists(run.workspace.root() / "oracle.json"));
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
