#pragma once
// Points where only a network knows depth.

#include <vector>

#include "oraclegs/depth/fusion.h"

namespace oraclegs {

/// A coarse grid of points on the pixels of monocular maps that are not confident and that no one of `points`, nor a
/// point added for an earlier photograph, falls on, unless that lies far behind; as far as no photograph whose depth is
/// confident looks through them. A point has the confidence of its pixel, found by one view. `photos` belong to
/// `maps`, one by one. Nothing without monocular maps.
std::vector<DensePoint> PriorPoints(const std::vector<DepthMap>& maps, const std::vector<LoadedView>& photos,
                                    const std::vector<DensePoint>& points, const FusionOptions& options);

}  // namespace oraclegs
