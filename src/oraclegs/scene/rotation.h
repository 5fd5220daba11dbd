#pragma once

#include <Eigen/Core>
#include <string>

namespace oraclegs {

/// A rotation, and by how much what was read was off it (the largest element).
struct ReadRotation {
  Eigen::Matrix3d rotation;
  double rounding = 0;
};

/// The rotation nearest to a matrix of few decimals. Throws InputError "PLACE ..." when it is not finite or more than
/// 0.01 off a rotation (a scale, a mirror).
ReadRotation NearestRotation(const Eigen::Matrix3d& matrix, const std::string& place);

}  // namespace oraclegs
