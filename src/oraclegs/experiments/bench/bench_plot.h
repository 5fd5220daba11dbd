#pragma once
// Plots of a benchmark: a line for each method, of means over all scenes. Means over some scenes would not compare.

#include <string>

#include "oraclegs/experiments/bench/bench_table.h"

namespace oraclegs {

/// Test PSNR over the number of training views, as an SVG image.
std::string PsnrOverViews(const BenchReport& report);

/// Test PSNR over the time from photos to the trained model, on a logarithmic axis; a point for each number of views,
/// joined from few to many.
std::string PsnrOverTime(const BenchReport& report);

}  // namespace oraclegs
