#pragma once

namespace oraclegs {

/// Flops a second of fused multiply-adds from registers, on all of the device; the median of eight.
double MeasureFmaRate();

}  // namespace oraclegs
