#pragma once
// The plots of a benchmark: means over all scenes, a line for each method; means over some of them would not compare.

#include <string>

#include "oraclegs/experiments/bench/bench_table.h"

namespace oraclegs {

/// Test PSNR over the number of training views, as an SVG image.
std::string PsnrOverViews(const BenchReport& report);

/// Test PSNR over the time from photos to the trained model, which has a logarithmic axis; a point for each number of
/// views, joined from few to many.
std::string PsnrOverTime(const BenchReport& report);

}  // namespace oraclegs
