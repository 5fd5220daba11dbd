#pragma once
// The order of Gaussians in a file: neighbors in space side by side, because what is alike packs well.

#include <cstdint>
#include <vector>

#include "oraclegs/gaussians/gaussians.h"

namespace oraclegs {

inline constexpr int64_t kSpatialGroup = 256;

/// The indices of all Gaussians, cut again and again across the longest side of their box: each run of kSpatialGroup
/// from the first on fills a small box, and so do its halves.
std::vector<int64_t> SpatialOrder(const Gaussians& gaussians);

}  // namespace oraclegs
