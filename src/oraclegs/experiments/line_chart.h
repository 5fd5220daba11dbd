#pragma once
// A chart of lines as an SVG image.

#include <string>
#include <vector>

namespace oraclegs {

struct ChartPoint {
  double x = 0, y = 0;
};

struct ChartLine {
  std::string name;  ///< stands at its end
  std::string color;
  std::vector<ChartPoint> points;  ///< from left to right
};

struct ChartTick {
  double x = 0;
  std::string text;
};

struct LineChart {
  std::string x_title, y_title;
  std::vector<ChartTick> ticks = {};  ///< of the x axis
  double x_low = 0, x_high = 1;       ///< its ends
  bool log_x = false;                 ///< x_low must be above 0 then
  std::vector<ChartLine> lines = {};  ///< those without points are left out
};

/// The y axis goes from a whole number to a whole number, at least one apart.
std::string ChartSvg(const LineChart& chart);

/// Colors that differ for most eyes, for the lines of a chart in turn.
std::string ChartColor(size_t line);

}  // namespace oraclegs
