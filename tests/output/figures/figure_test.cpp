#include "oraclegs/output/figures/figure.h"

#include <nlohmann/json.hpp>

#include "oraclegs/core/files.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/propose/proposal_files.h"
#include "oraclegs/run/reconstruct.h"
#include "oraclegs/stages/metrics.h"
#include "run/proposing.h"
#include "support/errors.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

class FigureTest : public ProposingTest {
 protected:
  oraclegs::Run Made(const std::string& out) {
    RunRequest request = Request(out);
    request.options.propose.proposers = std::string("warp");
    request.options.split.views = 10;
    request.options.train.iterations = 5;
    oraclegs::Run run = StartRun(request, Silent());
    Reconstruct(&run);
    return run;
  }
};

TEST_F(FigureTest, ShowsProposalsTheirConfidenceAndThePhotos) {
  const oraclegs::Run run = Made("confidence");
  FigureOptions options;
  options.rows = 2;
  const Sheet sheet = ConfidenceSheet(run, options);
  EXPECT_THAT(sheet.heads, ElementsAre("proposal", "confidence", "photo"));
  ASSERT_EQ(sheet.rows.size(), 2u);
  const std::vector<Panel>& row = sheet.rows[0];
  const std::string name = row[0].caption;
  EXPECT_EQ(row[0].image.data, ReadImage(run.workspace.proposals() / (name + ".png")).data);
  const Image8 gray = ReadImage(run.workspace.confidence() / (name + ".png"));
  const auto color = MapColor(ColorMap::kPlasma, static_cast<float>(gray.data[0]) / 255);
  EXPECT_TRUE(std::equal(color.begin(), color.end(), row[1].image.data.begin()));
  EXPECT_EQ(row[2].image.width, row[0].image.width);
  EXPECT_EQ(sheet.scale, ColorMap::kPlasma);

  options.show = sheet.rows[1][0].caption;
  const Sheet one = ConfidenceSheet(run, options);
  ASSERT_EQ(one.rows.size(), 1u);
  EXPECT_EQ(one.rows[0][0].caption, options.show);
  options.show = "nobody";
  EXPECT_THAT(MessageOf<InputError>([&] { ConfidenceSheet(run, options); }), HasSubstr("--show names 'nobody'"));
}

TEST_F(FigureTest, ComparesRunsOnTheirTestViews) {
  const fs::path first = Made("one").workspace.root(), second = Made("two").workspace.root();
  FigureOptions options;
  options.rows = 1, options.crop = "4,6,20,10", options.labels = "mcmc, ours";
  const Sheet sheet = ComparisonSheet({first, second}, options);
  EXPECT_THAT(sheet.heads, ElementsAre("mcmc", "ours", "photo"));
  ASSERT_EQ(sheet.rows.size(), 1u);
  const std::vector<Panel>& row = sheet.rows[0];
  ASSERT_EQ(row.size(), 3u);
  EXPECT_THAT(row[0].caption, HasSubstr(" dB"));
  const Image8 photo = ReadImage(first / "renders/test" / (row[2].caption + "_gt.png"));
  EXPECT_EQ(row[2].image.width, 20);
  EXPECT_EQ(row[2].image.height, 10);
  EXPECT_EQ(row[2].image.data[0], photo.data[static_cast<size_t>(6 * photo.width + 4) * 3]);

  options.crop = "70,0,40,10";
  EXPECT_THAT(MessageOf<UsageError>([&] { ComparisonSheet({first, second}, options); }), HasSubstr("reaches beyond"));
  for (const char* bad : {"1,2,3", "a,b,c,d", "1,2,0,4", "1,2,-3,4"}) {
    options.crop = bad;
    EXPECT_THAT(MessageOf<UsageError>([&] {
                  ComparisonSheet({first, second}, options);
                }),
                HasSubstr("--crop is"))
        << bad;
  }
  options.crop = "", options.labels = "one";
  EXPECT_THAT(MessageOf<UsageError>([&] { ComparisonSheet({first, second}, options); }), HasSubstr("--labels names 1"));
  options.labels = "";
  WritePng(second / "renders/test" / (row[2].caption + ".png"), {4, 4, 3, std::vector<uint8_t>(48, 1)});
  options.show = row[2].caption;
  EXPECT_THAT(MessageOf<InputError>([&] { ComparisonSheet({first, second}, options); }), HasSubstr("4 x 4"));
}

TEST_F(FigureTest, ShowsAScenesMedianViewByEachMethodOfABenchmark) {
  const fs::path bench = *temp / "bench";
  for (const char* name : {"bench/runs/a", "bench/runs/b"}) Made(name);
  const auto score = [](const char* method, int seed, const char* workspace) {
    return nlohmann::json{{"scene", "two"}, {"views", 10}, {"method", method},
                          {"seed", seed},   {"psnr", 20},  {"workspace", workspace}};
  };
  nlohmann::json failed = score("mcmc", 0, "runs/none");
  failed.erase("psnr"), failed["scene"] = "one", failed["failure"] = "has no images";
  nlohmann::json report = {
      {"scenes", {"two", "one"}},
      {"methods", {{{"name", "ours"}, {"label", "Ours"}}, {{"name", "mcmc"}, {"label", "MCMC"}}}},
      {"runs", {score("ours", 1, "runs/gone"), score("ours", 0, "runs/a"), score("mcmc", 0, "runs/b"), failed}}};
  WriteFileAtomically(bench / "bench.json", report.dump());
  EXPECT_TRUE(IsSuiteFolder(bench));
  EXPECT_FALSE(IsSuiteFolder(bench / "runs/a"));

  const Sheet sheet = SuiteSheet(bench, {});
  EXPECT_THAT(sheet.heads, ElementsAre("photo", "Ours", "MCMC"));
  ASSERT_EQ(sheet.rows.size(), 2u);
  const std::vector<Panel>&row = sheet.rows[0], &empty = sheet.rows[1];
  nlohmann::json views = ReadMetrics(bench / "runs/a").at("test").at("views");
  std::sort(views.begin(), views.end(), [](const auto& a, const auto& b) { return a.at("psnr") < b.at("psnr"); });
  const nlohmann::json& median = views[(views.size() - 1) / 2];
  const std::string name = FileName(median.at("name").get<std::string>());
  EXPECT_EQ(row[0].caption, "two, 10 views: " + name);
  EXPECT_EQ(row[0].image.data, ReadImage(bench / "runs/a/renders/test" / (name + "_gt.png")).data);
  EXPECT_EQ(row[1].caption, fmt::format("{:.2f} dB", median.at("psnr").get<double>()));
  EXPECT_EQ(row[2].image.data, ReadImage(bench / "runs/b/renders/test" / (name + ".png")).data);
  EXPECT_EQ(empty[0].caption, "one, 10 views");
  EXPECT_EQ(empty[1].caption, "not run");
  EXPECT_EQ(empty[2].caption, "has no images");
  EXPECT_EQ(empty[2].image.width, 0);

  FigureOptions options;
  options.show = views[0].at("name").get<std::string>(), options.crop = "4,6,20,10", options.labels = "A,B";
  const Sheet other = SuiteSheet(bench, options);
  EXPECT_THAT(other.heads, ElementsAre("photo", "A", "B"));
  EXPECT_THAT(other.rows[0][0].caption, testing::EndsWith(FileName(options.show)));
  EXPECT_EQ(other.rows[0][2].image.width, 20);
  options.labels = "A";
  EXPECT_THAT(MessageOf<UsageError>([&] { SuiteSheet(bench, options); }), HasSubstr("--labels names 1 methods"));

  report["runs"] = nlohmann::json::array({failed});
  WriteFileAtomically(bench / "bench.json", report.dump());
  EXPECT_THAT(MessageOf<InputError>([&] { SuiteSheet(bench, {}); }), HasSubstr("no run has scores yet"));
  WriteFileAtomically(bench / "bench.json", "{}");
  EXPECT_THAT(MessageOf<InputError>([&] { SuiteSheet(bench, {}); }), HasSubstr("no report of `oraclegs bench`"));
}

TEST_F(FigureTest, NeedsScoresAndProposals) {
  RunRequest request = Request("empty");
  request.options.propose.proposers = std::string("none");
  oraclegs::Run run = StartRun(request, Silent());
  Reconstruct(&run);
  EXPECT_THAT(MessageOf<InputError>([&] { ConfidenceSheet(run, {}); }), HasSubstr("oraclegs validate"));
  EXPECT_EQ(ComparisonSheet({run.workspace.root()}, {}).heads.size(), 2u) << "one run beside the photos";
}

}  // namespace
}  // namespace oraclegs
