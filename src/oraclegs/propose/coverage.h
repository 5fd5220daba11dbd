#pragma once

#include <vector>

#include "oraclegs/camera/camera.h"
#include "oraclegs/depth/fusion.h"

namespace oraclegs {

/// Indices of at most `count` candidates, best first: each next one is that which sees most of the points from where no
/// training camera and none chosen before has seen them. A point has the weight 1 - exp(-angle / 10 degrees), with the
/// angle to the nearest direction from which it was seen (PointsSeen). Ends when nothing is gained any more.
std::vector<size_t> ChooseByCoverage(const std::vector<DensePoint>& points, const std::vector<Camera>& train,
                                     const std::vector<Camera>& candidates, int count);

}  // namespace oraclegs
