#pragma once

#include <string>

#include "oraclegs/experiments/tampering_report.h"

namespace oraclegs {

/// Test PSNR over the tampered share as an SVG image: a line for each trust, with its name. What has no scores yet has
/// no line.
std::string TamperingPlot(const TamperingReport& report);

}  // namespace oraclegs
