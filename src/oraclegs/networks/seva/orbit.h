#pragma once
// Cameras on a circle around the point that a scene's cameras look at (docs/method.md#seva-trajectories).

#include <vector>

#include "oraclegs/networks/seva/cameras.h"

namespace oraclegs::seva {

/// Point nearest to all optical axes (least squares); of the line of such points that parallel axes have, the one
/// nearest to the mean of the centers. Throws ShapeError without views.
Eigen::Vector3d LookAtPoint(const std::vector<View>& views);

/// Up direction: minus the mean of the cameras' y axes, of unit length.
Eigen::Vector3d UpOf(const std::vector<View>& views);

/// `count` poses evenly on the full circle around the axis `up` through `center`, from `start` on; each looks at
/// `center`, also the first.
std::vector<Eigen::Isometry3d> Orbit(const Eigen::Vector3d& start, const Eigen::Vector3d& center,
                                     const Eigen::Vector3d& up, int64_t count);

/// Frames of a first pass: `count` poses on an orbit around the point that input images and targets look at. The orbit
/// starts at the first input image, whose own place is left out. Intrinsics are the first target's, or without targets
/// the first input image's.
std::vector<View> OrbitAnchors(const std::vector<View>& inputs, const std::vector<View>& targets, int64_t count);

}  // namespace oraclegs::seva
