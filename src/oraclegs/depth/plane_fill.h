#pragma once
// Extrapolation of planes into textureless regions: lawns, plain walls, table tops
// (docs/method.md#plane-extrapolation).

#include <vector>

#include "oraclegs/depth/fusion.h"

namespace oraclegs {

/// A coarse grid of points on pixels without a confident depth: a region without depth continues the plane of the scene
/// (scene_planes.h) that most confident pixels around it of the same color lie on, a lawn that of the lawn and not that
/// of the wall behind it. Of the other views that have the place in frame, one must show the same color there and none
/// may see through it; a place that no other view has in frame is accepted. `points` are those of FuseDepth with the
/// same arguments. A point has confidence 0 and one view. None beside silhouettes, where there are any (silhouettes.h),
/// or where a mask excludes. The same for any number of threads. Throws Interrupted.
std::vector<DensePoint> FillPlanes(const std::vector<DepthMap>& maps, const std::vector<LoadedView>& views,
                                   const std::vector<DensePoint>& points, const FusionOptions& options);

}  // namespace oraclegs
