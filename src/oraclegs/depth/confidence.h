#pragma once
// Confidence of depth in the others' absence (docs/method.md#depth-confidence).

#include <cstddef>
#include <vector>

#include "oraclegs/depth/depth_map.h"

namespace oraclegs {

/// Confidence of `maps[view]` had the `hidden` views not been there to agree with it: it falls by the share of the
/// agreement that was theirs, where no other view that is as near stands in. `view` is not one of them.
std::vector<float> ConfidenceWithout(const std::vector<DepthMap>& maps, size_t view, const std::vector<int>& hidden);

}  // namespace oraclegs
