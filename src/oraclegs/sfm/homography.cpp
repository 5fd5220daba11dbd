#include "oraclegs/sfm/homography.h"
#include "oraclegs/core/statistics.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

namespace oraclegs {
namespace {

constexpr size_t kMinMatches = 8;          // twice what determines a map
constexpr int kRounds = 4;                 // fits, each with the matches that the one before explains
constexpr double kMaxErrorOverMedian = 3;  // times the median error
constexpr int kFocalSteps = 24;
constexpr double kMinFocal = .5, kMaxFocal = 2.5;  // longer sides of the image
constexpr double kMinInlierLimit = .5;             // pixels: a match that is no worse is always an inlier

double ErrorOf(const Eigen::Matrix3d& h, const PointMatch& match) {
  const Eigen::Vector3d mapped = h * match.a.homogeneous();
  const double error = (mapped.hnormalized() - match.b).norm();
  return std::isfinite(error) ? error : std::numeric_limits<double>::infinity();
}

std::vector<PointMatch> Agreeing(const Eigen::Matrix3d& h, const std::vector<PointMatch>& matches) {
  std::vector<double> errors;
  for (const PointMatch& match : matches) errors.push_back(ErrorOf(h, match));
  const double limit = std::max(kMinInlierLimit, kMaxErrorOverMedian * UpperMedian(errors));
  std::vector<PointMatch> agreeing;
  for (size_t i = 0; i < matches.size(); ++i) {
    if (errors[i] <= limit && std::isfinite(errors[i])) agreeing.push_back(matches[i]);
  }
  return agreeing;
}

/// To points around the origin at a mean distance of sqrt(2).
Eigen::Matrix3d Normalizer(const std::vector<PointMatch>& matches, Eigen::Vector2d PointMatch::*side) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const PointMatch& match : matches) mean += match.*side / static_cast<double>(matches.size());
  double spread = 0;
  for (const PointMatch& match : matches) spread += (match.*side - mean).norm() / static_cast<double>(matches.size());
  const double scale = spread > 0 ? std::sqrt(2.) / spread : 1;
  Eigen::Matrix3d t;
  t << scale, 0, -scale * mean.x(), 0, scale, -scale * mean.y(), 0, 0, 1;
  return t;
}

Eigen::Matrix3d Fit(const std::vector<PointMatch>& matches) {
  const Eigen::Matrix3d ta = Normalizer(matches, &PointMatch::a), tb = Normalizer(matches, &PointMatch::b);
  Eigen::Matrix<double, 9, 9> normal = Eigen::Matrix<double, 9, 9>::Zero();
  for (const PointMatch& match : matches) {
    const Eigen::Vector3d a = ta * match.a.homogeneous(), b = tb * match.b.homogeneous();
    Eigen::Matrix<double, 2, 9> rows;
    rows << a.transpose(), Eigen::RowVector3d::Zero(), -b.x() * a.transpose(),  //
        Eigen::RowVector3d::Zero(), a.transpose(), -b.y() * a.transpose();
    normal += rows.transpose() * rows;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>> solver(normal);
  const Eigen::Matrix<double, 9, 1> h = solver.eigenvectors().col(0);  // of the smallest eigenvalue
  Eigen::Matrix3d map;
  map << h.head<3>().transpose(), h.segment<3>(3).transpose(), h.tail<3>().transpose();
  return tb.inverse() * map * ta;
}

}  // namespace

Eigen::Matrix3d RefitHomography(const Eigen::Matrix3d& start, const std::vector<PointMatch>& matches) {
  Eigen::Matrix3d map = start;
  for (int round = 0; round < kRounds && !matches.empty(); ++round) {
    const std::vector<PointMatch> agreeing = Agreeing(map, matches);
    if (agreeing.size() < kMinMatches) break;
    const Eigen::Matrix3d fitted = Fit(agreeing);
    if (!fitted.allFinite()) break;
    map = fitted;
  }
  return map;
}

double RotationResidual(const Eigen::Matrix3d& b_from_a, const std::array<int, 2>& size_a,
                        const std::array<int, 2>& size_b) {
  const auto intrinsics = [](const std::array<int, 2>& size, double sides) {
    const double focal = sides * std::max(size[0], size[1]);
    Eigen::Matrix3d k;
    k << focal, 0, size[0] / 2., 0, focal, size[1] / 2., 0, 0, 1;
    return k;
  };
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kFocalSteps; ++i) {
    const double sides = kMinFocal * std::pow(kMaxFocal / kMinFocal, i / (kFocalSteps - 1.));
    const Eigen::Matrix3d rotation = intrinsics(size_b, sides).inverse() * b_from_a * intrinsics(size_a, sides);
    const double scale = std::cbrt(rotation.determinant());
    if (!std::isfinite(scale) || scale == 0) continue;
    const Eigen::Vector3d singular = Eigen::JacobiSVD<Eigen::Matrix3d>(rotation / scale).singularValues();
    least = std::min(least, (singular.array() - 1).abs().maxCoeff());
  }
  return least;
}

}  // namespace oraclegs
