#include "oraclegs/experiments/tampering_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "experiments/tampering_example.h"

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

TEST(TamperingRecovery, IsTheShareOfTheIdealGain) {
  const TamperingReport report = TamperingExample();
  // Means: uniform 20.5, oracle 23.5, ideal 24.5.
  EXPECT_DOUBLE_EQ(*TamperingRecovery(report, 1), 0.75);
  EXPECT_FALSE(TamperingRecovery(report, 0)) << "an ideal oracle gains nothing where all is honest";
}

TEST(TamperingRecovery, IsNegativeWhereTheOracleHarms) {
  TamperingReport report = TamperingExample();
  for (TamperingRun& run : report.shares[1].runs) {
    if (run.trust == TamperingTrust::kOracle) run.psnr = 20;
  }
  EXPECT_DOUBLE_EQ(*TamperingRecovery(report, 1), -0.125);
}

TEST(TamperingPsnr, OfNoProposalsIsOneForAllShares) {
  const TamperingReport report = TamperingExample();
  EXPECT_DOUBLE_EQ(TamperingPsnr(report, 0, TamperingTrust::kNone)->mean, 24);
  EXPECT_DOUBLE_EQ(TamperingPsnr(report, 1, TamperingTrust::kNone)->mean, 24);
  EXPECT_FALSE(TamperingPsnr(TamperingReport(), 0, TamperingTrust::kNone));
}

TEST(WorstOverNone, IsTheSmallestDifference) {
  EXPECT_DOUBLE_EQ(*WorstOverNone(TamperingExample()), -0.5);
  EXPECT_FALSE(WorstOverNone({}));
}

TEST(TamperingText, HasALineForEachShare) {
  EXPECT_EQ(TamperingText(TamperingExample()),
            "12 training views, 7 test views, 31 proposals, 135 × 240 pixels, 2000 iterations, at most 30000 "
            "Gaussians, seeds 0, 1\n"
            "tampered          none       uniform        oracle         ideal  recovery  AUROC  in void  on tampered  "
            "on honest\n"
            "     0 %  24.00 ± 1.41  25.00 ± 0.00  24.50 ± 0.71  25.00 ± 0.00         -      -        -            -  "
            "    0.800\n"
            "    30 %  24.00 ± 1.41  20.50 ± 0.71  23.50 ± 0.71  24.50 ± 0.71      0.75  0.900    0.700        0.150  "
            "    0.600\n"
            "Worst of oracle − none: -0.50 dB\n"
            "AUROC by kind of lie\n"
            "kind       30 %\n"
            "displace      -\n"
            "swap      0.925\n"
            "tone          -\n"
            "smooth        -\n"
            "invent        -\n"
            "delete        -\n"
            "flicker       -\n");
}

TEST(TamperingToJson, HasEachSeedAndNullForWhatIsMissing) {
  const nlohmann::json json = TamperingToJson(TamperingExample());
  EXPECT_EQ(json.at("program"), "oraclegs");
  EXPECT_EQ(json.at("worst_over_none"), -0.5);
  EXPECT_EQ(json.at("none").at(1).at("psnr"), 25);
  const nlohmann::json &honest = json.at("shares").at(0), &third = json.at("shares").at(1);
  EXPECT_EQ(third.at("percent"), 30);
  EXPECT_EQ(third.at("recovery"), 0.75);
  EXPECT_EQ(third.at("psnr").at("oracle").at("count"), 2);
  EXPECT_EQ(third.at("runs").at(0).at("trust"), "uniform");
  EXPECT_EQ(third.at("confidence").at(0).at("lies"), 12);
  EXPECT_NEAR(third.at("auroc_of_kind").at("swap").get<double>(), 0.925, 1e-12);
  EXPECT_TRUE(third.at("auroc_of_kind").at("tone").is_null());
  EXPECT_TRUE(honest.at("recovery").is_null());
  EXPECT_TRUE(honest.at("auroc").is_null());
}

TEST(TamperingMarkdown, HasThePlotTheTableAndTheNotes) {
  EXPECT_THAT(TamperingMarkdown(TamperingExample()),
              AllOf(HasSubstr("# Tampering benchmark of fox\n"), HasSubstr("    oraclegs ablate fox\n"),
                    HasSubstr("](tampering.svg)"), HasSubstr("| 30 % | 24.00 ± 1.41 | 20.50 ± 0.71 | "),
                    HasSubstr("\nWorst of oracle − none: -0.50 dB.\n"),
                    HasSubstr("| kind | 30 % |\n| --- | --- |\n| displace | - |\n"), HasSubstr("- A note.\n")));
  EXPECT_THAT(TamperingMarkdown({}), AllOf(Not(HasSubstr("Worst")), Not(HasSubstr("kind |"))));
}

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

TEST(TamperingPlot, DrawsALineForEachTrust) {
  const std::string svg = TamperingPlot(TamperingExample());
  EXPECT_THAT(svg, AllOf(StartsWith("<svg "), HasSubstr("</svg>\n"), HasSubstr(">none</text>"),
                         HasSubstr(">uniform</text>"), HasSubstr(">oracle</text>"), HasSubstr(">ideal</text>")));
  // 0 % and 30 % of 480 pixels from 64 on; 20.5 and 25 dB on an axis of 20 to 25 dB over 328 pixels from 20 on.
  EXPECT_THAT(svg, HasSubstr("<polyline points=\"64.0,20.0 208.0,315.2 \""));
  EXPECT_THAT(svg, HasSubstr(">30 %</text>"));
}

TEST(TamperingPlot, OmitsWhatHasNoScores) {
  TamperingReport report = TamperingExample();
  report.none.clear();
  EXPECT_THAT(TamperingPlot(report), Not(HasSubstr(">none</text>")));
  EXPECT_THAT(TamperingPlot({}), AllOf(HasSubstr("</svg>"), Not(HasSubstr("polyline"))));
}

}  // namespace

}  // namespace oraclegs
