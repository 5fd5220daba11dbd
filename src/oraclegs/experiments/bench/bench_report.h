#pragma once
// The tables of a benchmark as text, Markdown, LaTeX, JSON and CSV. The rows are BenchRows'.

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "oraclegs/experiments/bench/bench_table.h"

namespace oraclegs {

/// For each number of views a table with a line for each scene and method, the means, and a line for each failure.
std::string BenchText(const BenchReport& report);

/// A document with a heading, the plots (bench-views.svg, bench-time.svg), the tables, best scores in bold, and notes.
std::string BenchMarkdown(const BenchReport& report);

/// For each number of views a table for the package booktabs, best scores in bold.
std::string BenchLatex(const BenchReport& report);

/// Everything, each run and each row; what there is none of is null.
nlohmann::json BenchToJson(const BenchReport& report);

/// A line for each row, with a head; what there is none of is empty.
std::string BenchCsv(const BenchReport& report);

}  // namespace oraclegs
