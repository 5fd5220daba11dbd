#include "oraclegs/experiments/bench/bench_plot.h"

#include <gmock/gmock.h>

#include "experiments/bench/bench_example.h"

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// Ours with 12 and 24 views in one scene: 20.5 dB after 205 s, 24.5 dB after 245 s.
BenchReport TwoNumbersOfViews() {
  BenchReport report = ExampleBench();
  report.scenes = {"garden"}, report.views = {12, 24}, report.methods.resize(1);
  report.runs.resize(2);
  for (const double psnr : {24, 25}) {
    report.runs.push_back(ExampleScore("garden", "paper", psnr > 24 ? 1 : 0, psnr));
    report.runs.back().views = 24;
  }
  return report;
}

TEST(PsnrOverViews, DrawsALineForEachMethod) {
  const std::string svg = PsnrOverViews(TwoNumbersOfViews());
  // From 64 over 480 pixels; 20.5 and 24.5 dB on an axis of 20 to 25 dB over 328 pixels from 20 on.
  EXPECT_THAT(svg, AllOf(HasSubstr("<polyline points=\"64.0,315.2 544.0,52.8 \""), HasSubstr(">12</text>"),
                         HasSubstr(">24</text>"), HasSubstr(">OracleGS</text>")));
}

TEST(PsnrOverViews, LeavesOutMeansOfSomeScenes) {
  const std::string svg = PsnrOverViews(ExampleBench());
  EXPECT_THAT(svg, AllOf(HasSubstr(">OracleGS</text>"), Not(HasSubstr(">3DGS-MCMC</text>")), Not(HasSubstr("nan"))));
}

TEST(PsnrOverViews, CountsTheViewsOfRunsWithAll) {
  BenchReport report = TwoNumbersOfViews();
  report.views = {0};
  for (BenchScore& run : report.runs) run.views = 0, run.train_views = 21;
  EXPECT_THAT(PsnrOverViews(report), HasSubstr(">21</text>"));
}

TEST(PsnrOverTime, HasALogarithmicAxis) {
  const std::string svg = PsnrOverTime(TwoNumbersOfViews());
  // 180 and 300 s on an axis from 205/1.5 to 245*1.5 s.
  EXPECT_THAT(svg, AllOf(HasSubstr(">3:00</text>"), HasSubstr("<text x=\"197.6\""), HasSubstr(">5:00</text>"),
                         Not(HasSubstr("nan"))));
  EXPECT_THAT(PsnrOverTime({}), AllOf(HasSubstr("</svg>"), Not(HasSubstr("polyline"))));
}

TEST(PsnrOverTime, HasAsManyTimesAsThereIsRoomFor) {
  BenchReport report = TwoNumbersOfViews();
  for (BenchScore& run : report.runs) {
    run.value[static_cast<size_t>(BenchValue::kSeconds)] = run.views == 24 ? 40000 : 4;
  }
  const std::string svg = PsnrOverTime(report);
  EXPECT_THAT(svg, AllOf(HasSubstr(">1:00</text>"), HasSubstr(">1:00:00</text>"), Not(HasSubstr(">3:00</text>"))));
}

}  // namespace
}  // namespace oraclegs
