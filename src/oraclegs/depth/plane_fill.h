#pragma once
// Points where stereo is blind but the scene goes on as it must: lawns, plain walls, table tops.

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
/// confident pixels around it lie on, as far as another photograph, of those that see the place, shows the same colour
/// there and none looks through it; what no other photograph sees is believed. `points` are those of FuseDepth with the
/// same arguments. A point has confidence 0, found by one view. Nothing beside silhouettes, where the photographs have
/// any (silhouettes.h), or where a mask excludes.
std::vector<DensePoint> FillPlanes(const std::vector<DepthMap>& maps, const std::vector<LoadedView>& photos,
                                   const std::vector<DensePoint>& points, const FusionOptions& options);

}  // namespace oraclegs
