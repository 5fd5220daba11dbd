#pragma once
// The large planes of a scene: floors, walls, tables (docs/method.md#plane-extrapolation).

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

/// The planes on which at least 0.5 % of the points are each, the largest first, at most 24. A point is on a plane when
/// it is within five of its pixels of it and its normal agrees. The result does not depend on the number of threads.
/// Throws Interrupted.
std::vector<ScenePlane> FindPlanes(const std::vector<DensePoint>& points);

}  // namespace oraclegs
