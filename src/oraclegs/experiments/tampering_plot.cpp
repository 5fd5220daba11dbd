#include "oraclegs/experiments/tampering_plot.h"

#include <fmt/format.h>

#include "oraclegs/experiments/line_chart.h"

namespace oraclegs {
namespace {

constexpr std::array kLineColors = {"#777777", "#c0392b", "#1f5fbf", "#2e8b57"};

}  // namespace

std::string TamperingPlot(const TamperingReport& report) {
  LineChart chart{.x_title = "tampered pixels of the proposals", .y_title = "test PSNR, dB", .x_high = 100};
  for (const TamperingShare& share : report.shares) {
    chart.ticks.push_back({static_cast<double>(share.percent), fmt::format("{} %", share.percent)});
  }
  for (size_t t = 0; t < kTamperingTrustNames.size(); ++t) {
    ChartLine line{kTamperingTrustNames[t], kLineColors[t], {}};
    for (size_t s = 0; s < report.shares.size(); ++s) {
      if (const auto psnr = TamperingPsnr(report, s, static_cast<TamperingTrust>(t))) {
        line.points.push_back({static_cast<double>(report.shares[s].percent), psnr->mean});
      }
    }
    chart.lines.push_back(std::move(line));
  }
  return ChartSvg(chart);
}

}  // namespace oraclegs
