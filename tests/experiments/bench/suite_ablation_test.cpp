#include "oraclegs/experiments/bench/suite_ablation.h"

#include <gmock/gmock.h>

#include "experiments/bench/small_bench.h"
#include "support/errors.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;
using testing::Not;

/// One scene of DTU, of nine views, and options that take such a one.
class SuiteAblationTest : public SmallBenchTest {
 protected:
  SuiteAblationTest() {
    std::filesystem::create_directories(dir / "data");
    std::filesystem::copy(*scenes / "one", dir / "data/scan8", std::filesystem::copy_options::recursive);
    request.run.scene = dir / "data", request.run.out = dir / "out", request.run.version = "test";
    request.options = {1, "mcmc,union"};
    request.options.suite = "dtu";
    settings.asked = {
        {"views", "3"}, {"train-views", ":1,:2,:3"}, {"test-views", ":0"}, {"downscale", "1"}, {"iterations", "50"}};
    settings.read_preset = [](const std::string& name) {
      if (name != "paper") return RunArguments{{"views", "6"}};
      return RunArguments{{"horizon", "90"}, {"iterations", "70"}, {"downscale", "8"}};
    };
  }

  AblationRequest request;
  SuiteSettings settings;
};

TEST_F(SuiteAblationTest, PlansTheScenesThatFitWithTheSuitesImages) {
  settings.preset = "paper";
  const SuiteAblation plan = PlanSuiteAblation(request, settings);
  ASSERT_EQ(plan.parts.size(), 1u);
  EXPECT_EQ(plan.parts[0].views, 3);
  EXPECT_EQ(plan.parts[0].scenes, std::vector{dir / "data/scan8"});
  EXPECT_EQ(plan.checks.size(), 15u) << "those that are missing, too";
  const RunOptions& options = plan.parts[0].request.run.options;
  EXPECT_EQ(options.train.horizon, 90);
  EXPECT_EQ(options.train.iterations, Auto<int>(50)) << "the user wins over the preset";
  EXPECT_EQ(options.image.downscale, 1) << "images are the suite's or the user's, not the preset's";
  EXPECT_TRUE(options.frame.force);

  const std::string text = SuiteAblationText(plan);
  EXPECT_THAT(text, HasSubstr("scan8, 3 views: 3 training images ("));
  EXPECT_THAT(text, HasSubstr("scan21, 3 views: cannot be run: "));
  EXPECT_THAT(text, HasSubstr("/out/3-views/scan8/rows/01-mcmc/seed-0 "));
  EXPECT_FALSE(std::filesystem::exists(dir / "out"));
}

TEST_F(SuiteAblationTest, TrainsAndWritesOneTable) {
  settings.asked.insert(settings.asked.end(), {{"max-gaussians", "500"}, {"init", "sfm"}});
  settings.asked[4].second = "5";
  request.options.rows = "mcmc";
  const auto means = RunSuiteAblation(request, PlanSuiteAblation(request, settings), Silent());
  ASSERT_EQ(means.size(), 1u);
  EXPECT_EQ(means[0].train_views, 3u);
  EXPECT_THAT(ReadFile(dir / "out/ablation.md"), HasSubstr("PSNR of 3"));
  EXPECT_THAT(ReadFile(dir / "out/ablation.md"), Not(HasSubstr("paper of"))) << "no scene of the paper's";
  EXPECT_TRUE(std::filesystem::exists(dir / "out/3-views/scan8/rows/01-mcmc/seed-0/metrics.json"));
}

TEST_F(SuiteAblationTest, RefusesWhatDoesNotFit) {
  settings.preset = "of-six";
  EXPECT_THAT(MessageOf<UsageError>([&] { PlanSuiteAblation(request, settings); }), HasSubstr("names 3"));
  settings.preset.clear(), request.options.also = "other";
  EXPECT_THAT(MessageOf<UsageError>([&] { PlanSuiteAblation(request, settings); }), HasSubstr("--also"));
  request.options.also.clear(), request.options.suite = scenes->path().string();
  EXPECT_THAT(MessageOf<UsageError>([&] { PlanSuiteAblation(request, settings); }), HasSubstr("no dataset of papers"));
  request.options.suite = "dtu", settings.asked = {{"views", "3"}};
  EXPECT_THAT(MessageOf<InputError>([&] { PlanSuiteAblation(request, settings); }), HasSubstr("scan8"))
      << "fewer than 49 images";
}

}  // namespace
}  // namespace oraclegs
