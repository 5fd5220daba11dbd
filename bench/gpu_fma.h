#pragma once

namespace oraclegs {

/// Measures flops per second of fused multiply-adds from registers on the whole device; the median of eight.
double MeasureFmaRate();

}  // namespace oraclegs
