#pragma once
// The paper's tables, out of tests/golden/paper_tables.md.

#include <sstream>
#include <string>
#include <vector>

#include "oraclegs/core/files.h"
#include "oraclegs/core/text.h"
#include "support/golden.h"

namespace oraclegs {

/// "17.73 / 0.432 / 0.520" as numbers.
inline std::vector<double> Numbers(const std::string& cell) {
  std::vector<double> numbers;
  for (const std::string& number : SplitTrimmed(cell, '/')) numbers.push_back(std::stod(number));
  return numbers;
}

/// Cells of the rows of a table of tests/golden/paper_tables.md, below its two lines of headings.
inline std::vector<std::vector<std::string>> PaperTable(const std::string& heading) {
  const std::string text = ReadFile(GoldenDir() / "paper_tables.md");
  std::istringstream lines(text.substr(text.find(heading)));
  std::vector<std::vector<std::string>> rows;
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line) && line.starts_with("|")) rows.push_back(SplitTrimmed(line, '|'));
  rows.erase(rows.begin(), rows.begin() + 2);
  return rows;
}

}  // namespace oraclegs
