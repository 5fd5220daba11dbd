#pragma once
// Extrapolation of planes into textureless regions: lawns, plain walls, table tops
// (docs/method.md#plane-extrapolation).

#include <Eigen/Core>
#include <vector>

#include "oraclegs/depth/fusion.h"

namespace oraclegs {

/// Points on a coarse grid of pixels without a confident depth: such a region continues the plane that most of the
/// confident pixels around it that have its color lie on; where they do not agree, nothing. Of the other views that
/// have the place in frame, one must show the same color there and none may see through it; a place that no other view
/// has in frame is accepted. A point has confidence 0 and one view. None beside silhouettes, where there are any
/// (silhouettes.h), or where a mask excludes. The same for any number of threads. Throws Interrupted.
std::vector<DensePoint> FillPlanes(const std::vector<DepthMap>& maps, const std::vector<LoadedView>& views,
                                   const FusionOptions& options);

}  // namespace oraclegs
