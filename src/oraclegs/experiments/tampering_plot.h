#pragma once

#include <string>

#include "oraclegs/experiments/tampering_report.h"

namespace oraclegs {

/// Test PSNR over the tampered share as an SVG image: a line, with its name, for each trust that has scores.
std::string TamperingPlot(const TamperingReport& report);

}  // namespace oraclegs
