#pragma once
// A change of coordinates: turned, scaled and moved as one rigid thing.

#include <Eigen/Core>

#include "oraclegs/camera/camera.h"

namespace oraclegs {

/// x -> scale * rotation * x + translation, in doubles.
struct Similarity {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  ///< proper: determinant 1
  double scale = 1;                                        ///< > 0
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const { return scale * (rotation * point) + translation; }
  /// Applies `first`, then this one.
  Similarity operator*(const Similarity& first) const;
  Similarity Inverse() const;
  bool IsIdentity() const;
};

/// Pose of a camera whose world is moved: it sees the moved world as it saw the old one, with lengths times the scale.
Eigen::Isometry3d Moved(const Eigen::Isometry3d& cam_from_world, const Similarity& transform);

/// Pose of a camera that turns about its center, before which everything shifts then: a point x of its frame becomes
/// Exp(turn) x + shift. `turn`: axis times angle, radians; both in camera axes.
Eigen::Isometry3d Nudged(const Eigen::Isometry3d& cam_from_world, const Eigen::Vector3d& turn,
                         const Eigen::Vector3d& shift);

}  // namespace oraclegs
