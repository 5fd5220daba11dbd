#pragma once
// Extrapolation of planes into textureless regions: lawns, plain walls, table tops
// (docs/method.md#plane-extrapolation).

#include <vector>

#include "oraclegs/depth/fusion.h"

namespace oraclegs {

/// A coarse grid of points on pixels without a confident depth. A region without depth continues the plane of the scene
/// (scene_planes.h) of most confident pixels of its color around it: a lawn continues the lawn and not the wall behind
/// it. One of the other views with the place in frame must show the same color there, and none may see through it; a
/// place that no other view has in frame is accepted. `points` are those of FuseDepth with the same arguments. A point
/// has confidence 0 and one view. No points outside silhouettes, where there are any (silhouettes.h), or where a mask
/// excludes. The result does not depend on the number of threads. Throws Interrupted.
std::vector<DensePoint> FillPlanes(const std::vector<DepthMap>& maps, const std::vector<LoadedView>& views,
                                   const std::vector<DensePoint>& points, const FusionOptions& options);

}  // namespace oraclegs
