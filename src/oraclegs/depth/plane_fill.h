#pragma once
// Extrapolation of planes into textureless regions: lawns, plain walls, table tops
// (docs/method.md#plane-extrapolation).

#include <Eigen/Core>
#include <vector>

#include "oraclegs/depth/fusion.h"

namespace oraclegs {

/// normal . x + offset = 0, world frame.
struct ScenePlane {
  Eigen::Vector3f normal;  ///< unit
  float offset = 0;

  float Distance(const Eigen::Vector3f& xyz) const { return normal.dot(xyz) + offset; }
};

/// The planes on which at least 0.5 % of the points each lie, the largest first, at most 24. A point lies on a plane
/// when it is within five of its pixels of it and its normal agrees. The same for any number of threads.
std::vector<ScenePlane> FindPlanes(const std::vector<DensePoint>& points);

/// A coarse grid of points on pixels without a confident depth: a region without depth continues the plane that most
/// confident pixels around it lie on. Of the other views that have the place in frame, one must show the same colour
/// there and none may see through it; a place that no other view has in frame is accepted. `points` are those of
/// FuseDepth with the same arguments. A point has confidence 0 and one view. None beside silhouettes, where there are
/// any (silhouettes.h), or where a mask excludes.
std::vector<DensePoint> FillPlanes(const std::vector<DepthMap>& maps, const std::vector<LoadedView>& views,
                                   const std::vector<DensePoint>& points, const FusionOptions& options);

}  // namespace oraclegs
