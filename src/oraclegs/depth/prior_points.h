#pragma once
// Points where only a network has depth (docs/method.md#plane-extrapolation).

#include <vector>

#include "oraclegs/depth/fusion.h"

namespace oraclegs {

/// A coarse grid of points on the pixels of monocular maps that are not confident. Left out are pixels that one of
/// `points`, or a point added for an earlier view, covers (points far behind cover nothing), and points that a
/// confident depth of another view sees through. A point has the confidence of its pixel and one view. `views` belong
/// to `maps`, one by one. None without monocular maps.
std::vector<DensePoint> PriorPoints(const std::vector<DepthMap>& maps, const std::vector<LoadedView>& views,
                                    const std::vector<DensePoint>& points, const FusionOptions& options);

}  // namespace oraclegs
