#pragma once

#include <algorithm>
#include <vector>

namespace oraclegs {

/// The upper one of two for an even number; 0 for none.
inline double Median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<int64_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace oraclegs
