#include "oraclegs/experiments/bench/bench_plan.h"

#include <gmock/gmock.h>

#include <set>

#include "experiments/bench/small_bench.h"
#include "support/errors.h"

namespace oraclegs {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class BenchPlanTest : public SmallBenchTest {};

std::string ValueAfter(const std::vector<std::string>& words, const std::string& option) {
  const auto at = std::find(words.begin(), words.end(), option);
  return at == words.end() || at + 1 == words.end() ? "" : at[1];
}

TEST_F(BenchPlanTest, HasEveryCombinationOnce) {
  const BenchRequest request = Request();
  const BenchPlan plan = PlanBench(request);
  EXPECT_EQ(plan.runs.size(), 16u);
  std::set<std::string> names;
  for (const BenchRun& run : plan.runs) names.insert(run.name);
  EXPECT_EQ(names.size(), 16u);
  EXPECT_EQ(names.count(plan.suite.name + "-two-5-3dgs-mcmc-seed1"), 1u);
  EXPECT_FALSE(plan.keeps_protocol) << "a folder has none";
}

TEST_F(BenchPlanTest, MethodsWinOverTheUserWhoWinsOverWhatIsUsual) {
  BenchRequest request = Request();
  request.asked = {{"iterations", "50"}, {"proposers", "warp"}, {"test-every", "4"}};
  const BenchPlan plan = PlanBench(request);
  const auto ours = CommandOf(request, plan, plan.runs[0]), mcmc = CommandOf(request, plan, plan.runs[1]);
  EXPECT_EQ(ValueAfter(ours, "--proposers"), "warp");
  EXPECT_EQ(ValueAfter(mcmc, "--proposers"), "none") << "it is what the method is";
  EXPECT_EQ(ValueAfter(mcmc, "--iterations"), "50") << "not its usual 10000";
  EXPECT_EQ(ValueAfter(ours, "--test-every"), "4");
  request.asked.clear();
  EXPECT_EQ(ValueAfter(CommandOf(request, PlanBench(request), PlanBench(request).runs[1]), "--iterations"), "10000");
}

TEST_F(BenchPlanTest, PresetsChangeNoMethodOfOthersButItsImages) {
  BenchRequest request = Request();
  request.asked.clear();
  request.preset = {{"iterations", "70"}, {"horizon", "90"}, {"downscale", "2"}, {"proposers", "warp"}};
  const BenchPlan plan = PlanBench(request);
  const auto ours = CommandOf(request, plan, plan.runs[0]), mcmc = CommandOf(request, plan, plan.runs[1]);
  EXPECT_EQ(ValueAfter(ours, "--iterations"), "70");
  EXPECT_EQ(ValueAfter(ours, "--proposers"), "warp");
  EXPECT_THAT(ours, testing::Contains("horizon=90"));
  EXPECT_EQ(ValueAfter(mcmc, "--iterations"), "10000");
  EXPECT_THAT(mcmc, testing::Not(testing::Contains("horizon=90")));
  EXPECT_EQ(ValueAfter(mcmc, "--downscale"), "2") << "the same images for all";
  request.asked = {{"iterations", "50"}};
  EXPECT_EQ(ValueAfter(CommandOf(request, PlanBench(request), PlanBench(request).runs[0]), "--iterations"), "50");
  request.preset = {{"views", "4"}};
  EXPECT_THAT(MessageOf<UsageError>([&] { PlanBench(request); }), HasSubstr("names 3"));
}

TEST_F(BenchPlanTest, ThePaperIsItsPresetOfTheSuiteAndTheNumberOfViews) {
  BenchRequest request = Request();
  request.options.methods = "paper,3dgs-mcmc", request.asked.clear();
  std::set<std::string> read;
  request.read_preset = [&](const std::string& name) {
    read.insert(name);
    return RunArguments{{"iterations", "70"}, {"horizon", "90"}, {"views", "9"}, {"downscale", "8"}};
  };
  const BenchPlan plan = PlanBench(request);
  const auto paper = CommandOf(request, plan, plan.runs[0]), mcmc = CommandOf(request, plan, plan.runs[1]);
  EXPECT_EQ(read, std::set<std::string>{"paper"}) << "scenes of no dataset";
  EXPECT_EQ(ValueAfter(paper, "--iterations"), "70");
  EXPECT_THAT(paper, testing::Contains("horizon=90"));
  EXPECT_EQ(ValueAfter(paper, "--views"), "3") << "images are the suite's";
  EXPECT_THAT(paper, testing::Not(testing::Contains("--downscale")));
  EXPECT_THAT(mcmc, testing::Not(testing::Contains("horizon=90")));
  request.asked = {{"iterations", "50"}};
  EXPECT_EQ(ValueAfter(CommandOf(request, PlanBench(request), PlanBench(request).runs[0]), "--iterations"), "50");
}

TEST_F(BenchPlanTest, AnotherStartCanBeAskedFor) {
  BenchRequest request = Request();
  request.options.methods = "3dgs,3dgs-mcmc-random", request.asked = {{"init", "sfm"}};
  const BenchPlan plan = PlanBench(request);
  EXPECT_EQ(ValueAfter(CommandOf(request, plan, plan.runs[0]), "--init"), "sfm");
  EXPECT_EQ(ValueAfter(CommandOf(request, plan, plan.runs[1]), "--init"), "random-cube") << "it is what the method is";
}

TEST_F(BenchPlanTest, CommandsNameSceneWorkspaceAndSeed) {
  BenchRequest request = Request();
  request.options.methods = "ours", request.first_seed = 7;
  const BenchPlan plan = PlanBench(request);
  EXPECT_THAT(CommandOf(request, plan, plan.runs[1]),
              ElementsAre("/bin/oraclegs", "reconstruct", (*scenes / "one").string(), "--out",
                          (dir / "out/runs").string() + "/" + plan.suite.name + "-one-3-ours-seed8", "--views", "3",
                          "--test-every", "8", "--iterations", "50", "--seed", "8", "--no-report", "--force"));
  const std::string text = PlanText(request, plan);
  EXPECT_THAT(text, HasSubstr("8 runs; OracleGS (this program)\n"));
  EXPECT_THAT(text, HasSubstr("one, 3 views: 3 training images (images/001.png, "));
  EXPECT_THAT(text, HasSubstr("\n/bin/oraclegs reconstruct "));
}

TEST_F(BenchPlanTest, NamedSuitesSayWhetherTheirProtocolIsKept) {
  std::filesystem::create_directories(dir / "data");
  std::filesystem::copy(*scenes / "one", dir / "data/scan8", std::filesystem::copy_options::recursive);
  BenchRequest request = Request();
  request.options.suite = "dtu", request.options.data = dir / "data", request.options.views = "3";
  EXPECT_THAT(MessageOf<InputError>([&] { PlanBench(request); }), HasSubstr("scan8")) << "fewer than 49 images";
  request.asked = {{"train-views", ":1,:2,:3"}, {"test-views", ":0"}, {"downscale", "1"}};
  const BenchPlan plan = PlanBench(request);
  EXPECT_EQ(plan.runs.size(), 15u * 4);
  EXPECT_EQ(plan.checks[0].problem, "");
  request.options.methods = "cor-gs";
  const BenchPlan of_cor_gs = PlanBench(request);
  EXPECT_THAT(CommandOf(request, of_cor_gs, of_cor_gs.runs[0]), testing::Contains("method=cor-gs-dtu"));
  EXPECT_THAT(plan.checks[1].problem, HasSubstr("scan21: is missing"));
  EXPECT_THAT(PlanText(request, plan), HasSubstr("not the suite's protocol"));
  request.options.views.clear();
  EXPECT_THAT(MessageOf<UsageError>([&] { PlanBench(request); }), HasSubstr("runs of 3, 6, 9 views"));
}

TEST_F(BenchPlanTest, RefusesOptionsThatDoNotFit) {
  BenchRequest request = Request();
  request.asked = {{"iterations", "0"}};
  EXPECT_THAT(MessageOf<UsageError>([&] { PlanBench(request); }), HasSubstr("--iterations"));
  request = Request();
  request.options.views = "3,9";
  EXPECT_THAT(PlanBench(request).checks[1].problem, HasSubstr("--views asks for 9"));
  request.options.views = "9";
  EXPECT_THAT(MessageOf<InputError>([&] { PlanBench(request); }), HasSubstr("--views asks for 9"));
}

}  // namespace
}  // namespace oraclegs
