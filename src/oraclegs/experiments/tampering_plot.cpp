#include "oraclegs/experiments/tampering_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace oraclegs {
namespace {

constexpr double kWidth = 640, kHeight = 400, kLeft = 64, kRight = 96, kTop = 20, kBottom = 52;
constexpr double kNameHeight = 14;  // of the lines' names, which must not overlap
constexpr std::array kLineColors = {"#777777", "#c0392b", "#1f5fbf", "#2e8b57"};

struct PlotPoint {
  double percent, psnr;
};

struct PlotLine {
  const char* name;
  const char* color;
  std::vector<PlotPoint> points;
};

std::vector<PlotLine> LinesOf(const TamperingReport& report) {
  std::vector<PlotLine> lines;
  for (size_t t = 0; t < kTamperingTrustNames.size(); ++t) {
    PlotLine line{kTamperingTrustNames[t], kLineColors[t], {}};
    for (size_t s = 0; s < report.shares.size(); ++s) {
      if (const auto psnr = TamperingPsnr(report, s, static_cast<TamperingTrust>(t))) {
        line.points.push_back({static_cast<double>(report.shares[s].percent), psnr->mean});
      }
    }
    if (!line.points.empty()) lines.push_back(std::move(line));
  }
  return lines;
}

/// The whole dB that the lines lie between, at least one apart.
struct PlotRange {
  double low = 0, high = 1;

  static PlotRange Of(const std::vector<PlotLine>& lines) {
    std::vector<double> values;
    for (const PlotLine& line : lines) {
      for (const PlotPoint& point : line.points) values.push_back(point.psnr);
    }
    if (values.empty()) return {};
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    const double floor = std::floor(*low);
    return {floor, std::max(floor + 1, std::ceil(*high))};
  }
};

double X(double percent) { return kLeft + (kWidth - kLeft - kRight) * percent / 100; }

double Y(double psnr, const PlotRange& range) {
  return kTop + (kHeight - kTop - kBottom) * (range.high - psnr) / (range.high - range.low);
}

std::string PlotText(double x, double y, const char* anchor, const std::string& text) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", x, y, anchor, text);
}

std::string Axes(const TamperingReport& report, const PlotRange& range) {
  std::string svg;
  const double step = range.high - range.low > 8 ? 2 : 1;
  const int lines = static_cast<int>((range.high - range.low) / step) + 1;
  for (int line = 0; line < lines; ++line) {
    const double psnr = range.low + line * step;
    const double y = Y(psnr, range);
    svg += fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"#dddddd\"/>\n", kLeft, y,
                       kWidth - kRight, y);
    svg += PlotText(kLeft - 8, y + 4, "end", fmt::format("{:.0f}", psnr));
  }
  for (const TamperingShare& share : report.shares) {
    svg += PlotText(X(share.percent), kHeight - kBottom + 20, "middle", fmt::format("{} %", share.percent));
  }
  svg += PlotText((kLeft + kWidth - kRight) / 2, kHeight - 10, "middle", "tampered pixels of the proposals");
  const double middle = (kTop + kHeight - kBottom) / 2;
  svg += fmt::format(
      "<text x=\"16\" y=\"{:.1f}\" text-anchor=\"middle\" transform=\"rotate(-90 16 {:.1f})\">"
      "test PSNR, dB</text>\n",
      middle, middle);
  return svg;
}

}  // namespace

std::string TamperingPlot(const TamperingReport& report) {
  std::vector<PlotLine> lines = LinesOf(report);
  const PlotRange range = PlotRange::Of(lines);
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" "
      "font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"{0}\" height=\"{1}\" fill=\"white\"/>\n",
      kWidth, kHeight);
  svg += Axes(report, range);
  std::sort(lines.begin(), lines.end(),
            [](const PlotLine& a, const PlotLine& b) { return a.points.back().psnr > b.points.back().psnr; });
  double free_from = 0;
  for (const PlotLine& line : lines) {
    std::string points;
    for (const PlotPoint& point : line.points) {
      points += fmt::format("{:.1f},{:.1f} ", X(point.percent), Y(point.psnr, range));
      svg += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"{}\"/>\n", X(point.percent),
                         Y(point.psnr, range), line.color);
    }
    svg +=
        fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\"/>\n", points, line.color);
    const double y = std::max(Y(line.points.back().psnr, range) + 4, free_from);
    free_from = y + kNameHeight;
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" fill=\"{}\">{}</text>\n", X(line.points.back().percent) + 10, y,
                       line.color, line.name);
  }
  return svg + "</svg>\n";
}

}  // namespace oraclegs
