#pragma once
// Keypoints of two images that look alike, by descriptors of unit length.

#include <cstdint>
#include <vector>

#include "oraclegs/core/buffer.h"

namespace oraclegs {

/// A keypoint of each of two images, by index.
struct FeatureMatch {
  uint32_t a = 0, b = 0;
  bool operator==(const FeatureMatch&) const = default;
};

/// Matches of learned descriptors. In (0, 1]: the distance to the nearest descriptor over that to the second nearest.
inline constexpr double kMaxDistanceRatio = 0.9;

/// The pairs of descriptors a [A, size] and b [B, size], of unit length, that are nearest to each other, where the
/// second nearest of either is farther away by the factor 1 / max_ratio. Ordered by the first. Swapping a and b swaps
/// the indices. The result does not depend on the number of threads. Throws ShapeError.
std::vector<FeatureMatch> MatchDescriptors(const Buffer<float>& a, const Buffer<float>& b,
                                           double max_ratio = kMaxDistanceRatio);

}  // namespace oraclegs
