#include "oraclegs/experiments/tampering_plot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "experiments/tampering_example.h"

namespace oraclegs {
namespace {

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
