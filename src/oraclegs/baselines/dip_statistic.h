#pragma once
// Hartigan's dip, a number for how far a sample is from having one mode.

#include <vector>

namespace oraclegs {

/// The dip of a sample [Hartigan 1985]: the largest difference between its distribution function and the unimodal one
/// that comes closest. Between 1 / (2 n), for samples of one mode, and 1/4, for two equal heaps; 0 for an empty sample.
/// Numbers must be finite; they are sorted. O(n log n).
double DipStatistic(std::vector<float> sample);

}  // namespace oraclegs
