#pragma once
// Points where only a network has depth (docs/method.md#plane-extrapolation).

#include <vector>

#include "oraclegs/depth/fusion.h"

namespace oraclegs {

/// A coarse grid of points on the pixels of monocular maps that are not confident. Excluded are pixels covered by one
/// of `points` or by a point added for an earlier view (points far behind cover nothing), and points that a confident
/// depth of another view sees through. A point has the confidence of its pixel and one view. `views` correspond to
/// `maps`. Empty without monocular maps.
std::vector<DensePoint> PriorPoints(const std::vector<DepthMap>& maps, const std::vector<LoadedView>& views,
                                    const std::vector<DensePoint>& points, const FusionOptions& options);

}  // namespace oraclegs
