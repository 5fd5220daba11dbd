#include "oraclegs/experiments/ablation_report.h"

#include <gmock/gmock.h>

#include <cmath>

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

AblationRun Ran(uint64_t seed, double psnr) {
  AblationRun run;
  run.seed = seed, run.workspace = "rows/x";
  run.psnr = psnr, run.ssim = psnr / 100, run.lpips = 0.5 - psnr / 100, run.psnr_color_corrected = psnr + 1;
  run.training_seconds = 60, run.gaussians = 500, run.start = "random";
  return run;
}

AblationRun Failed(uint64_t seed) {
  AblationRun run;
  run.seed = seed, run.failure = "scene: no points";
  return run;
}

Ablation Example() {
  Ablation a;
  a.scene = "fox", a.command = "oraclegs ablate fox -o out", a.version = "1.2.3";
  a.train_views = 12, a.test_views = 7, a.width = 270, a.height = 480, a.iterations = 7000, a.max_gaussians = 100000;
  a.seeds = {0, 1, 2};
  a.rows = {{1, "mcmc", "MCMC, random start", "alone", {{"init", "random"}}, {Ran(0, 20), Ran(1, 21), Ran(2, 22)}},
            {2, "proposals", "+ proposals", "views", {{"prune-floaters", false}}, {Failed(0), Failed(1), Failed(2)}},
            {3, "schedule", "+ schedule", "a|b", {{"proposal-folder", ""}}, {Ran(2, 23.5), Failed(1), Ran(0, 20.5)}},
            {4, "sfm", "+ SfM start", "points", {}, {}}};
  a.notes = {"A note."};
  return a;
}

TEST(SideBySide, PutsNumbersOfViewsBesideEachOther) {
  Ablation less = Example(), more = Example();
  more.train_views = 24, more.scenes = {"all"}, more.published_views = 24;
  more.rows.erase(more.rows.begin() + 1);
  more.rows[0].runs = {Ran(0, 25)};
  const std::string text = SideBySideText({less, more}), document = SideBySideMarkdown({less, more});
  EXPECT_THAT(text, AllOf(HasSubstr("PSNR of 12"), HasSubstr("PSNR of 24"), HasSubstr("paper of 24"),
                          Not(HasSubstr("paper of 12")), HasSubstr("misprint")));
  EXPECT_THAT(document, HasSubstr("| 1 MCMC, random start | 21.00 ± 1.00 | 0.2100 ± 0.0100 | 0.2900 ± 0.0100 | 25.00 | "
                                  "0.2500 | 0.2500 | 17.95 / 0.479 / 0.409 |"));
  EXPECT_THAT(document, HasSubstr("| 2 + proposals | - | - | - | - | - | - | - |"));
}

TEST(StatisticOf, IsMeanAndSampleDeviation) {
  EXPECT_FALSE(StatisticOf(std::vector<double>{}));
  EXPECT_EQ(StatisticOf({7.0})->mean, 7);
  EXPECT_FALSE(StatisticOf({7.0})->deviation) << "one value says nothing of the deviation";
  const auto statistic = StatisticOf({1.0, 2.0, 6.0});
  EXPECT_DOUBLE_EQ(statistic->mean, 3);
  EXPECT_DOUBLE_EQ(*statistic->deviation, std::sqrt(7.0));
  EXPECT_EQ(statistic->count, 3u);
}

TEST(GainOf, ComparesSeedBySeedWithTheNearestRowThatHasScores) {
  const auto gain = GainOf(Example(), 2);
  EXPECT_EQ(gain->over, 0u);
  EXPECT_DOUBLE_EQ(gain->psnr.mean, 1);  // +0.5 and +1.5
  EXPECT_DOUBLE_EQ(*gain->psnr.deviation, std::sqrt(0.5));
  EXPECT_FALSE(GainOf(Example(), 0));
  EXPECT_FALSE(GainOf(Example(), 3));
  Ablation other = Example();
  other.rows[2].runs = {Ran(9, 20)};
  EXPECT_FALSE(GainOf(other, 2)) << "no seed in common";
}

TEST(AblationText, AlignsScoresAndTellsFailures) {
  EXPECT_EQ(
      AblationText(Example()),
      "12 training views, 7 test views, 270 × 480 pixels, 7000 iterations, at most 100000 Gaussians, seeds 0, 1, "
      "2\n"
      "row                           PSNR             SSIM            LPIPS     corrected          gain  training\n"
      "1 MCMC, random start  21.00 ± 1.00  0.2100 ± 0.0100  0.2900 ± 0.0100  22.00 ± 1.00             -      1:00\n"
      "2 + proposals         failed: scene: no points\n"
      "3 + schedule          22.00 ± 2.12  0.2200 ± 0.0212  0.2800 ± 0.0212  23.00 ± 2.12  +1.00 ± 0.71      1:00\n"
      "4 + SfM start         not run yet\n"
      "row 3 (+ schedule), seed 1 failed: scene: no points\n");
}

TEST(AblationText, ShowsNoDeviationOfOneSeedAndNoScoresWithoutTestPixels) {
  Ablation a = Example();
  a.seeds = {5};
  a.rows = {{1, "mcmc", "MCMC", "alone", {}, {Ran(5, 20)}}};
  EXPECT_THAT(AblationText(a), AllOf(HasSubstr("seed 5\n"), HasSubstr("20.00  0.2000  0.3000"), Not(HasSubstr("±"))));
  a.rows[0].runs[0].psnr = a.rows[0].runs[0].ssim = a.rows[0].runs[0].lpips = a.rows[0].runs[0].psnr_color_corrected =
      std::nullopt;
  EXPECT_THAT(AblationText(a), HasSubstr("1 MCMC     -     -      -          -     -      1:00\n"));
}

TEST(AblationToJson, HasEachSeedAndItsFailure) {
  const nlohmann::json json = AblationToJson(Example());
  EXPECT_EQ(json.at("program"), "oraclegs");
  EXPECT_EQ(json.at("version"), "1.2.3");
  EXPECT_EQ(json.at("command"), "oraclegs ablate fox -o out");
  EXPECT_EQ(json.at("views").at("train"), 12);
  EXPECT_EQ(json.at("seeds"), nlohmann::json({0, 1, 2}));
  const nlohmann::json& row = json.at("rows").at(2);
  EXPECT_EQ(row.at("number"), 3);
  EXPECT_EQ(row.at("psnr").at("mean"), 22);
  EXPECT_EQ(row.at("psnr").at("count"), 2);
  EXPECT_EQ(row.at("gain").at("mean"), 1);
  EXPECT_EQ(row.at("gain_over"), "mcmc");
  EXPECT_EQ(row.at("runs").at(0).at("psnr"), 23.5);
  EXPECT_EQ(row.at("runs").at(0).at("gaussians"), 500);
  EXPECT_EQ(row.at("runs").at(0).at("start"), "random");
  EXPECT_EQ(row.at("runs").at(1).at("failure"), "scene: no points");
  EXPECT_FALSE(row.at("runs").at(1).contains("psnr"));
  EXPECT_TRUE(json.at("rows").at(3).at("psnr").is_null());
  EXPECT_TRUE(json.at("rows").at(3).at("gain").is_null());
  EXPECT_EQ(json.at("rows").at(0).at("changes"), nlohmann::json({{"init", "random"}}));
}

TEST(AblationMarkdown, HasHeadingTablesAndNotes) {
  EXPECT_EQ(AblationMarkdown(Example()),
            "# Ablation of fox\n"
            "\n"
            "12 training views, 7 test views, 270 × 480 pixels, 7000 iterations, at most 100000 Gaussians, seeds 0, 1, "
            "2; oraclegs 1.2.3.\n"
            "\n"
            "    oraclegs ablate fox -o out\n"
            "\n"
            "| row | PSNR, dB | SSIM | LPIPS | PSNR, color-corrected | gain, dB | training |\n"
            "| --- | --- | --- | --- | --- | --- | --- |\n"
            "| 1 MCMC, random start | 21.00 ± 1.00 | 0.2100 ± 0.0100 | 0.2900 ± 0.0100 | 22.00 ± 1.00 | - | 1:00 |\n"
            "| 2 + proposals | failed: scene: no points | | | | | |\n"
            "| 3 + schedule | 22.00 ± 2.12 | 0.2200 ± 0.0212 | 0.2800 ± 0.0212 | 23.00 ± 2.12 | +1.00 ± 0.71 | 1:00 |\n"
            "| 4 + SfM start | not run yet | | | | | |\n"
            "\n"
            "| row | adds | options |\n"
            "| --- | --- | --- |\n"
            "| 1 MCMC, random start | alone | `--init random` |\n"
            "| 2 + proposals | views | `--no-prune-floaters` |\n"
            "| 3 + schedule | a\\|b | `no --proposal-folder` |\n"
            "| 4 + SfM start | points |  |\n"
            "\n"
            "- row 3 (+ schedule), seed 1 failed: scene: no points\n"
            "- A note.\n");
}

}  // namespace
}  // namespace oraclegs
