#include "oraclegs/depth/depth_map.h"

#include <algorithm>

namespace oraclegs {

double ConfidentShare(const DepthMap& map) {
  if (map.confidence.empty()) return 0;
  const auto n = std::count_if(map.confidence.begin(), map.confidence.end(), [](float c) { return c >= kConfident; });
  return static_cast<double>(n) / static_cast<double>(map.confidence.size());
}

}  // namespace oraclegs
