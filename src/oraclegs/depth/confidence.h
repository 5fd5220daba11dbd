#pragma once
// Depth confidence (docs/method.md#depth-confidence).

#include "oraclegs/depth/patch_match.h"

namespace oraclegs {

/// Confidence of each pixel's depth in one view, [0, 1], from the finished maps of all views. It is high where other
/// views found the same surface from angles wide enough to measure, where patches are similar, and where no other view
/// sees through the point. Pixels that differ from their surroundings, and islands of few pixels, get little.
std::vector<float> Confidence(const StereoScene& scene, size_t view, const std::vector<PlaneMap>& maps);

}  // namespace oraclegs
