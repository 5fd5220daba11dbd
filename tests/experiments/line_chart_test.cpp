#include "oraclegs/experiments/line_chart.h"

#include <gmock/gmock.h>

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

TEST(ChartSvg, PlacesPointsAndTicks) {
  const LineChart chart{.x_title = "x & y",
                        .y_title = "dB",
                        .ticks = {{10, "ten"}},
                        .x_low = 0,
                        .x_high = 10,
                        .lines = {{"a", "red", {{0, 1}, {10, 2}}}, {"empty", "blue", {}}}};
  const std::string svg = ChartSvg(chart);
  EXPECT_THAT(svg, AllOf(HasSubstr("<polyline points=\"64.0,348.0 544.0,20.0 \""), HasSubstr(">x &amp; y</text>"),
                         HasSubstr("<text x=\"544.0\" y=\"368.0\" text-anchor=\"middle\">ten</text>"),
                         Not(HasSubstr(">empty</text>"))));
}

TEST(ChartSvg, LogarithmicAxisHasEqualRatiosAtEqualDistances) {
  const LineChart chart{
      .x_title = "", .y_title = "", .x_low = 1, .x_high = 100, .log_x = true, .lines = {{"a", "red", {{10, 1}}}}};
  EXPECT_THAT(ChartSvg(chart), HasSubstr("cx=\"304.0\""));
}

TEST(ChartSvg, OnePlaceStandsInTheMiddle) {
  const LineChart chart{.x_title = "", .y_title = "", .x_low = 8, .x_high = 8, .lines = {{"a", "red", {{8, 1}}}}};
  EXPECT_THAT(ChartSvg(chart), HasSubstr("cx=\"304.0\""));
}

TEST(ChartSvg, NamesDoNotOverlap) {
  const LineChart chart{.x_title = "", .y_title = "", .lines = {{"a", "red", {{1, 1.5}}}, {"b", "blue", {{1, 1.49}}}}};
  const std::string svg = ChartSvg(chart);
  EXPECT_THAT(svg, AllOf(HasSubstr("y=\"188.0\" fill=\"red\">a<"), HasSubstr("y=\"202.0\" fill=\"blue\">b<")));
}

}  // namespace
}  // namespace oraclegs
