#include "oraclegs/core/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace oraclegs {
namespace {

/// Characters: bytes that do not continue one.
size_t WidthOf(const std::string& text) {
  return static_cast<size_t>(std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xc0) != 0x80; }));
}

}  // namespace

std::string FormatSeconds(double seconds) {
  const auto s = static_cast<int64_t>(std::llround(std::clamp(seconds, 0.0, 1e9)));
  if (s >= 3600) return fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
  return fmt::format("{}:{:02}", s / 60, s % 60);
}

std::string AlignColumns(const std::vector<std::vector<std::string>>& rows, const std::string& sides) {
  std::vector<size_t> widths(sides.size(), 0);
  for (const auto& row : rows) {
    const size_t own = row.size() < sides.size() && !row.empty() ? row.size() - 1 : row.size();
    for (size_t c = 0; c < own; ++c) widths[c] = std::max(widths[c], WidthOf(row[c]));
  }
  std::string text;
  for (const auto& row : rows) {
    std::string line;
    for (size_t c = 0; c < row.size(); ++c) {
      if (c > 0) line += "  ";
      const bool reaches_over = row.size() < sides.size() && c + 1 == row.size();
      const std::string blanks(reaches_over ? 0 : widths[c] - WidthOf(row[c]), ' ');
      line += sides[c] == 'r' ? blanks + row[c] : row[c] + blanks;
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

}  // namespace oraclegs
