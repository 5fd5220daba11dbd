#pragma once

#include <vector>

#include "oraclegs/camera/camera.h"
#include "oraclegs/depth/fusion.h"

namespace oraclegs {

/// Indices of at most `count` candidates, best first. Each next one sees the most points from directions in which no
/// training camera and no candidate chosen before has seen them: a point (PointsSeen) has the weight 1 - exp(-angle /
/// 10 degrees), with the angle to the nearest such direction. Ends when nothing is gained any more.
std::vector<size_t> ChooseByCoverage(const std::vector<DensePoint>& points, const std::vector<Camera>& train,
                                     const std::vector<Camera>& candidates, int count);

}  // namespace oraclegs
