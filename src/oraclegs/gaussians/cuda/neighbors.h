#pragma once

#include <Eigen/Core>
#include <vector>

namespace oraclegs::cuda {

/// KdTree::MeanSquaredDistanceToThree (gaussians/neighbors.h) on the current GPU: exact, in double, and the same but
/// for the last digit. Coordinates must be finite. Throws OutOfMemory (it needs about 50 bytes a point), and
/// ShapeError for 2^31 points.
std::vector<double> MeanSquaredDistanceToThree(const std::vector<Eigen::Vector3f>& points);

}  // namespace oraclegs::cuda
