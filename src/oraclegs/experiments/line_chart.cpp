#include "oraclegs/experiments/line_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace oraclegs {
namespace {

constexpr double kWidth = 640, kHeight = 400, kLeft = 64, kTop = 20, kBottom = 52;
constexpr double kMinRight = 96;    // room for the names of the lines
constexpr double kLetter = 7;       // width of a letter, pixels
constexpr double kNameHeight = 14;  // distance of names that do not overlap, pixels

std::string Escaped(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '&') {
      escaped += "&amp;";
    } else if (c == '<') {
      escaped += "&lt;";
    } else {
      escaped += c;
    }
  }
  return escaped;
}

std::string TextAt(double x, double y, const char* anchor, const std::string& text) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", x, y, anchor, Escaped(text));
}

/// Draws one chart.
class ChartDrawing {
 public:
  explicit ChartDrawing(const LineChart& chart) : chart_(chart) {
    std::vector<double> values;
    for (const ChartLine& line : chart.lines) {
      if (!line.points.empty()) lines_.push_back(&line);
      for (const ChartPoint& point : line.points) values.push_back(point.y);
      right_ = std::max(right_, 16 + kLetter * static_cast<double>(line.name.size()));
    }
    if (values.empty()) return;
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    low_ = std::floor(*low), high_ = std::max(low_ + 1, std::ceil(*high));
  }

  std::string Svg() {
    std::string svg = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" "
        "font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"{0}\" height=\"{1}\" fill=\"white\"/>\n",
        Width(), kHeight);
    return svg + Axes() + Lines() + "</svg>\n";
  }

 private:
  double PlotWidth() const { return kWidth - kLeft - kMinRight; }
  double Width() const { return kLeft + PlotWidth() + right_; }

  double X(double x) const {
    const auto place = [&](double value) { return chart_.log_x ? std::log(value) : value; };
    const double low = place(chart_.x_low), high = place(chart_.x_high);
    return kLeft + PlotWidth() * (high > low ? (place(x) - low) / (high - low) : 0.5);
  }
  double Y(double y) const { return kTop + (kHeight - kTop - kBottom) * (high_ - y) / (high_ - low_); }

  std::string Axes() const {
    std::string svg;
    const double step = high_ - low_ > 8 ? 2 : 1;
    const int count = static_cast<int>((high_ - low_) / step) + 1;
    for (int line = 0; line < count; ++line) {
      const double value = low_ + line * step, y = Y(value);
      svg += fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"#dddddd\"/>\n", kLeft,
                         y, kLeft + PlotWidth(), y);
      svg += TextAt(kLeft - 8, y + 4, "end", fmt::format("{:.0f}", value));
    }
    for (const ChartTick& tick : chart_.ticks) svg += TextAt(X(tick.x), kHeight - kBottom + 20, "middle", tick.text);
    svg += TextAt(kLeft + PlotWidth() / 2, kHeight - 10, "middle", chart_.x_title);
    const double middle = (kTop + kHeight - kBottom) / 2;
    svg += fmt::format(
        "<text x=\"16\" y=\"{:.1f}\" text-anchor=\"middle\" transform=\"rotate(-90 16 {:.1f})\">{}</text>\n", middle,
        middle, Escaped(chart_.y_title));
    return svg;
  }

  std::string Lines() {
    std::sort(lines_.begin(), lines_.end(),
              [](const ChartLine* a, const ChartLine* b) { return a->points.back().y > b->points.back().y; });
    std::string svg;
    double free_from = 0;
    for (const ChartLine* line : lines_) {
      std::string points;
      for (const ChartPoint& point : line->points) {
        points += fmt::format("{:.1f},{:.1f} ", X(point.x), Y(point.y));
        svg += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"{}\"/>\n", X(point.x), Y(point.y),
                           line->color);
      }
      svg += fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\"/>\n", points,
                         line->color);
      const double y = std::max(Y(line->points.back().y) + 4, free_from);
      free_from = y + kNameHeight;
      svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" fill=\"{}\">{}</text>\n", X(line->points.back().x) + 10, y,
                         line->color, Escaped(line->name));
    }
    return svg;
  }

  const LineChart& chart_;
  std::vector<const ChartLine*> lines_;
  double low_ = 0, high_ = 1, right_ = kMinRight;
};

}  // namespace

std::string ChartSvg(const LineChart& chart) { return ChartDrawing(chart).Svg(); }

std::string ChartColor(size_t line) {
  constexpr std::array kColors = {"#1f5fbf", "#c0392b", "#2e8b57", "#8e44ad", "#d08000",
                                  "#777777", "#00838f", "#ad1457", "#5d4037", "#000000"};
  return kColors[line % kColors.size()];
}

}  // namespace oraclegs
