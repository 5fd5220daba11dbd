#pragma once
// Line charts as SVG images.

#include <string>
#include <vector>

namespace oraclegs {

struct ChartPoint {
  double x = 0, y = 0;
};

struct ChartLine {
  std::string name;  ///< shown at its end
  std::string color;
  std::vector<ChartPoint> points;  ///< from left to right
};

struct ChartTick {
  double x = 0;
  std::string text;
};

struct LineChart {
  std::string x_title, y_title;
  std::vector<ChartTick> ticks = {};  ///< ticks of the x axis
  double x_low = 0, x_high = 1;       ///< ends of the x axis
  bool log_x = false;                 ///< requires x_low > 0
  std::vector<ChartLine> lines = {};  ///< lines without points are left out
};

/// SVG of a chart. The y axis goes from a whole number to a whole number, at least one apart.
std::string ChartSvg(const LineChart& chart);

/// Color of a line by its index. Neighbors differ for most eyes.
std::string ChartColor(size_t line);

}  // namespace oraclegs
