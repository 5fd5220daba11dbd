#include "oraclegs/scene/rotation.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>

#include "oraclegs/core/error.h"

namespace oraclegs {
namespace {

constexpr double kMaxRounding = 1e-2;  // two decimals

/// Says by R R' and the determinant what is wrong with a matrix that is not a rotation.
std::string WhyNoRotation(const Eigen::Matrix3d& r) {
  const double det = r.determinant();
  const double scale = std::cbrt(std::abs(det));
  if (scale > 0 && ((r / scale) * (r / scale).transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < 1e-3) {
    if (det < 0) return "is a mirror image of a rotation (determinant < 0); its axes are not those of OpenGL";
    return fmt::format("is a rotation scaled by {:.6g}; divide its first three columns by that", scale);
  }
  const double deviation = (r * r.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  return fmt::format("is not a rotation (R R' differs from the identity by {:.3g})", deviation);
}

}  // namespace

ReadRotation NearestRotation(const Eigen::Matrix3d& matrix, const std::string& place) {
  // Decimals in the file leave the matrix slightly off; the nearest rotation makes its transpose the exact inverse.
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d rotation = svd.matrixU() * svd.matrixV().transpose();
  const double rounding = (matrix - rotation).cwiseAbs().maxCoeff();
  if (!matrix.allFinite() || !(rounding <= kMaxRounding) || matrix.determinant() < 0) {
    throw InputError("{} {}", place, WhyNoRotation(matrix));
  }
  return {rotation, rounding};
}

}  // namespace oraclegs
