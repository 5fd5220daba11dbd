#pragma once
// Which depths to believe.

#include "oraclegs/depth/patch_match.h"

namespace oraclegs {

/// How likely each pixel's depth of one view is right, [0, 1], from the finished maps of all views: that other views
/// found the same surface, from angles wide enough to measure; that the patch looked alike; that no other view sees
/// through it. Pixels that stand out of their surroundings, and islands of few pixels, lose most of it.
std::vector<float> Confidence(const StereoScene& scene, size_t view, const std::vector<PlaneMap>& maps);

}  // namespace oraclegs
