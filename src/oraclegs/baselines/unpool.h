#pragma once
// Proximity-guided Gaussian unpooling of FSGS [Zhu 2024] (section 3.2, eq. 3 and 4): new Gaussians in the gaps of a
// sparse start.

#include <cstdint>
#include <vector>

#include "oraclegs/gaussians/gaussians.h"

namespace oraclegs {

/// Limits above which a Gaussian is large and far from the others. The proximity score is the mean squared distance to
/// the K = 3 nearest other centers, as in the public code. The paper's (eq. 4) is the mean distance, with a threshold
/// of 10 world units for Gaussians of any size.
struct ProximityLimits {
  double score = 0;  ///< on the proximity score, squared world units
  double scale = 0;  ///< on the greatest standard deviation, world units

  /// Limits of the public code for sources of new Gaussians. extent: 1.1 times the largest distance of a training
  /// camera from the cameras' mean (SpatialExtent).
  static ProximityLimits Unpool(double extent) { return {5 * extent, extent}; }
  /// Limits of the code of FSGS and CoR-GS for Gaussians that are split in two whatever their gradient.
  static ProximityLimits Split(double extent) { return {10 * extent, extent}; }
};

/// Rows of the Gaussians above both limits, by falling score; ties in the order of the rows. Empty for fewer than 4
/// Gaussians.
std::vector<int64_t> IsolatedGaussians(const ProximityLimits& limits, const Gaussians& gaussians);

/// Adds a Gaussian at the middle of each edge from a source, a Gaussian above both limits, to each of its 3 nearest
/// neighbors, its destinations. It has the destination's scale and opacity, no rotation, and is gray (all SH
/// coefficients 0). Where there would be more than max_gaussians in all, sources of the largest score come first and
/// the last one may lose its farther destinations. Does nothing for fewer than 4 Gaussians. Returns the number added.
/// The buffers are grown in place where their memory has room (Buffer::GrownTo).
///
/// FSGS does this every 100 iterations from 500, by the code only before 2000. (The code pairs the sources with
/// destinations of other sources where there is more than one; this follows the paper.)
///
/// The result does not depend on the number of threads.
int64_t UnpoolGaussians(const ProximityLimits& limits, int64_t max_gaussians, Gaussians* gaussians);

}  // namespace oraclegs
