#pragma once
// A map between the pixels of two images, fitted to points seen in both.

#include <Eigen/Core>
#include <array>
#include <vector>

namespace oraclegs {

/// One point seen in two images, in pixels of each.
struct PointMatch {
  Eigen::Vector2d a, b;
};

/// The map b ~ H a that fits all `matches` best (least squares over points scaled to unit spread, outliers beyond three
/// times the median error left out), beginning with `start`, which separates inliers from outliers. A map out of the
/// four points of a RANSAC sample is off by many pixels where it had no point; this one is not. `start` itself when
/// fewer than eight matches agree on a better one. Source: Hartley and Zisserman, Multiple View Geometry, alg. 4.2.
Eigen::Matrix3d RefitHomography(const Eigen::Matrix3d& start, const std::vector<PointMatch>& matches);

/// Distance of a homography from a pure rotation of the camera, K_b R K_a^-1, over the focal lengths that cameras
/// have: the largest departure of a singular value of R from 1. A step aside by the t-th part of the distance to a
/// plane gives about t. Sizes are (width, height) in pixels. Infinite for a map that is no homography of two cameras.
double RotationResidual(const Eigen::Matrix3d& b_from_a, const std::array<int, 2>& size_a,
                        const std::array<int, 2>& size_b);

}  // namespace oraclegs
