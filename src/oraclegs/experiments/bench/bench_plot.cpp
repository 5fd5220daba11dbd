#include "oraclegs/experiments/bench/bench_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "oraclegs/core/text.h"
#include "oraclegs/experiments/line_chart.h"

namespace oraclegs {
namespace {

constexpr char kPsnrTitle[] = "test PSNR, dB (mean over scenes)";

/// Lines of the means over all scenes. place(row) is the x of a mean, nullopt = not drawn.
template <class PlaceOf>
std::vector<ChartLine> LinesOf(const BenchReport& report, const PlaceOf& place) {
  const std::vector<BenchRow> rows = BenchRows(report);
  std::vector<ChartLine> lines;
  for (const BenchMethod& method : report.methods) {
    ChartLine line{method.label, ChartColor(lines.size()), {}};
    for (const BenchRow& row : rows) {
      const bool is_of_all = row.is_mean() && row.source.empty() && row.scored == row.of;
      if (!is_of_all || row.method != method.name) continue;
      const auto& psnr = row.value[static_cast<size_t>(BenchValue::kPsnr)];
      const std::optional<double> x = place(row);
      if (psnr && x) line.points.push_back({*x, psnr->mean});
    }
    lines.push_back(std::move(line));
  }
  return lines;
}

/// Number of training views of a row; a row with all views has the mean over its runs.
std::optional<double> ViewsIn(const BenchReport& report, const BenchRow& row) {
  if (row.views > 0) return row.views;
  double sum = 0, count = 0;
  for (const BenchScore& run : report.runs) {
    if (run.views != 0 || run.method != row.method || !run.is_scored()) continue;
    sum += static_cast<double>(run.train_views);
    count += 1;
  }
  return count > 0 ? std::optional(sum / count) : std::nullopt;
}

struct PlaceRange {
  double low = 0, high = 0;
  bool any = false;
};

PlaceRange RangeOf(const std::vector<ChartLine>& lines) {
  PlaceRange range;
  for (const ChartLine& line : lines) {
    for (const ChartPoint& point : line.points) {
      range.low = range.any ? std::min(range.low, point.x) : point.x;
      range.high = std::max(range.high, point.x);
      range.any = true;
    }
  }
  return range;
}

/// Round times for an axis, as many as their texts have room for.
std::vector<ChartTick> TimeTicks(double low, double high) {
  constexpr size_t kMaxTicks = 7;
  constexpr double kSeconds = 1, kMinutes = 60, kHours = 3600;
  const std::vector<double> fine = {1, 2, 3, 5, 10, 20, 30}, coarse = {1, 3, 10, 30}, rough = {1, 10};
  std::vector<ChartTick> ticks;
  for (const std::vector<double>& counts : {fine, coarse, rough}) {
    ticks.clear();
    for (const double unit : {kSeconds, kMinutes, kHours}) {
      for (const double count : counts) {
        const double seconds = unit * count;
        if (seconds >= low && seconds <= high) ticks.push_back({seconds, FormatSeconds(seconds)});
      }
    }
    if (ticks.size() <= kMaxTicks) break;
  }
  return ticks;
}

}  // namespace

std::string PsnrOverViews(const BenchReport& report) {
  LineChart chart{.x_title = "training views", .y_title = kPsnrTitle};
  chart.lines = LinesOf(report, [&](const BenchRow& row) { return ViewsIn(report, row); });
  const PlaceRange range = RangeOf(chart.lines);
  chart.x_low = range.low, chart.x_high = range.high;
  for (const ChartLine& line : chart.lines) {
    for (const ChartPoint& point : line.points) {
      const bool is_new = std::none_of(chart.ticks.begin(), chart.ticks.end(),
                                       [&](const ChartTick& tick) { return tick.x == point.x; });
      if (is_new) chart.ticks.push_back({point.x, fmt::format("{:.4g}", point.x)});
    }
  }
  return ChartSvg(chart);
}

std::string PsnrOverTime(const BenchReport& report) {
  LineChart chart{.x_title = "time from photos to the trained model", .y_title = kPsnrTitle, .log_x = true};
  chart.lines = LinesOf(report, [](const BenchRow& row) -> std::optional<double> {
    const auto& seconds = row.value[static_cast<size_t>(BenchValue::kSeconds)];
    return seconds && seconds->mean > 0 ? std::optional(seconds->mean) : std::nullopt;
  });
  const PlaceRange range = RangeOf(chart.lines);
  if (!range.any) return ChartSvg({.x_title = chart.x_title, .y_title = chart.y_title});
  constexpr double kRoom = 1.5;  // space beside the points, so that most have a round time on either side
  chart.x_low = range.low / kRoom, chart.x_high = range.high * kRoom;
  chart.ticks = TimeTicks(chart.x_low, chart.x_high);
  return ChartSvg(chart);
}

}  // namespace oraclegs
