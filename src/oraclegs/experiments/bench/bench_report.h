#pragma once
// Tables of a benchmark as text, Markdown, LaTeX, JSON and CSV, with the rows of BenchRows.

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "oraclegs/experiments/bench/bench_table.h"

namespace oraclegs {

/// Text with a table for each number of views: a line for each scene and method, the means, and a line for each
/// failure.
std::string BenchText(const BenchReport& report);

/// Document with a heading, the plots (bench-views.svg, bench-time.svg), the tables, best scores in bold, and notes.
std::string BenchMarkdown(const BenchReport& report);

/// Table for each number of views, for the package booktabs, best scores in bold.
std::string BenchLatex(const BenchReport& report);

/// JSON with every run and every row; missing values are null.
nlohmann::json BenchToJson(const BenchReport& report);

/// Header and a line for each row; missing values are empty.
std::string BenchCsv(const BenchReport& report);

}  // namespace oraclegs
