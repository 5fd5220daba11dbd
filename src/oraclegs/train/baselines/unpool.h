#pragma once
// Proximity-guided Gaussian unpooling of FSGS [Zhu 2024] (section 3.2, eq. 3 and 4): new Gaussians in the gaps of a
// sparse start.

#include <cstdint>
#include <vector>

#include "oraclegs/gaussians/gaussians.h"

namespace oraclegs {

/// What makes a Gaussian lonely: a large one that stands far from the others. The proximity score is the mean squared
/// distance to the K = 3 nearest other centers, as in the public code. The paper's (eq. 4) is the mean distance, with a
/// threshold of 10 world units for Gaussians of any size.
struct ProximityLimits {
  double score = 0;  ///< lonely ones have a larger one, squared world units
  double scale = 0;  ///< and a larger greatest standard deviation, world units

  /// Of the code, for sources of new Gaussians. extent: 1.1 times the largest distance of a training camera from their
  /// mean (SpatialExtent).
  static ProximityLimits Unpool(double extent) { return {5 * extent, extent}; }
  /// Of the code of FSGS and CoR-GS, for those that are split in two whatever their gradient.
  static ProximityLimits Split(double extent) { return {10 * extent, extent}; }
};

/// Rows of the lonely ones, the largest score first; of equal ones the first in order. None where there are fewer than
/// 4 Gaussians.
std::vector<int64_t> LonelyGaussians(const ProximityLimits& limits, const Gaussians& gaussians);

/// Adds a Gaussian at the middle of each edge from a source, a lonely Gaussian, to each of its 3 nearest neighbors, its
/// destinations: scale and opacity of the destination, no rotation, gray (all SH coefficients 0). Where there would be
/// more than max_gaussians in all, sources of the largest score come first and the last one may lose its farther
/// destinations. Nothing happens where there are fewer than 4 Gaussians. Returns how many were added. The buffers are
/// grown in place where their memory has room (Buffer::GrownTo).
///
/// FSGS: every 100 iterations from 500, by the code only before 2000. (The code pairs the sources with destinations of
/// other sources where there is more than one; this follows the paper.)
///
/// The same for any number of threads.
int64_t UnpoolGaussians(const ProximityLimits& limits, int64_t max_gaussians, Gaussians* gaussians);

}  // namespace oraclegs
