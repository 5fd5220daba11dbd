#include "oraclegs/sfm/two_motions.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "oraclegs/core/rng.h"

namespace oraclegs {
namespace {

// Shares of the longer side: 1.5 and 6 pixels of 1500.
constexpr double kStill = .001, kNearly = .004;
constexpr double kOnPlane = .002;
constexpr double kOfOneMotion = .008;  // of an affine map of a thing in motion, whose own parallax it leaves out
constexpr double kApart = .012;        // from where the camera's motion would allow a feature
constexpr int kMinStill = 12, kMinMoving = 12, kMinApart = 10;
constexpr double kMinShareApart = .25;  // of the outliers
constexpr double kMinApartOverInliers = .05;
constexpr double kMinSharePlanar = .96;  // of the inliers
constexpr int kMinInliersForPlane = 30;
constexpr int kSamples = 400;
constexpr size_t kMinForMotion = 8;  // matches: what determines an epipolar geometry

/// The epipolar geometry of matches, by the normalized eight-point method.
Eigen::Matrix3d FitEpipolar(const std::vector<PointMatch>& matches) {
  Eigen::Matrix3d t[2];
  for (int side = 0; side < 2; ++side) {
    const auto at = [&](const PointMatch& m) { return side == 0 ? m.a : m.b; };
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    for (const PointMatch& m : matches) mean += at(m) / static_cast<double>(matches.size());
    double spread = 0;
    for (const PointMatch& m : matches) spread += (at(m) - mean).norm() / static_cast<double>(matches.size());
    const double scale = spread > 0 ? std::sqrt(2.) / spread : 1;
    t[side] << scale, 0, -scale * mean.x(), 0, scale, -scale * mean.y(), 0, 0, 1;
  }
  Eigen::Matrix<double, 9, 9> normal = Eigen::Matrix<double, 9, 9>::Zero();
  for (const PointMatch& m : matches) {
    const Eigen::Vector3d a = t[0] * m.a.homogeneous(), b = t[1] * m.b.homogeneous();
    Eigen::Matrix<double, 9, 1> row;
    row << b.x() * a, b.y() * a, a;
    normal += row * row.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>> solver(normal);
  const Eigen::Matrix<double, 9, 1> f = solver.eigenvectors().col(0);  // of the smallest eigenvalue
  Eigen::Matrix3d matrix;
  matrix << f.head<3>().transpose(), f.segment<3>(3).transpose(), f.tail<3>().transpose();
  return t[1].transpose() * matrix * t[0];
}

/// How far, in pixels, a match is from its epipolar line, on the farther side.
double DistanceFromLine(const Eigen::Matrix3d& epipolar, const PointMatch& match) {
  const Eigen::Vector3d line_b = epipolar * match.a.homogeneous();
  const Eigen::Vector3d line_a = epipolar.transpose() * match.b.homogeneous();
  const double error = std::abs(match.b.homogeneous().dot(line_b));
  const double slope = std::min(line_a.head<2>().norm(), line_b.head<2>().norm());
  return slope > 0 ? error / slope : 0;
}

double Displacement(const PointMatch& match) { return (match.b - match.a).norm(); }

/// b = A (a, 1) through three matches; nothing when they lie on a line.
std::optional<Eigen::Matrix<double, 2, 3>> AffineMap(const std::array<const PointMatch*, 3>& matches) {
  Eigen::Matrix3d from;
  Eigen::Matrix<double, 2, 3> to;
  for (int i = 0; i < 3; ++i) {
    from.col(i) = matches[static_cast<size_t>(i)]->a.homogeneous();
    to.col(i) = matches[static_cast<size_t>(i)]->b;
  }
  if (std::abs(from.determinant()) < 1) return std::nullopt;
  return to * from.inverse();
}

/// Most of `matches` that one affine map explains within `limit` pixels.
int LargestAgreement(const std::vector<PointMatch>& matches, double limit) {
  int largest = 0;
  for (uint64_t sample = 0; sample < kSamples; ++sample) {
    const auto draw = Philox::Draw(matches.size(), static_cast<uint64_t>(RandomStream::kSecondMotion), sample);
    std::array<const PointMatch*, 3> three{};
    for (size_t i = 0; i < 3; ++i) three[i] = &matches[draw.x[i] % matches.size()];
    const auto map = AffineMap(three);
    if (!map) continue;
    const auto agrees = [&](const PointMatch& m) { return (*map * m.a.homogeneous() - m.b).norm() <= limit; };
    largest = std::max(largest, static_cast<int>(std::count_if(matches.begin(), matches.end(), agrees)));
  }
  return largest;
}

}  // namespace

bool MotionCounts::HasStillPart() const { return still >= kMinStill && still > nearly && moving >= kMinMoving; }

bool MotionCounts::HasMovedPart() const { return apart >= kMinApart && apart >= kMinApartOverInliers * inliers; }

bool MotionCounts::IsPlanar() const { return inliers >= kMinInliersForPlane && planar >= kMinSharePlanar * inliers; }

MotionCounts CountMotions(const AlikeFeatures& features) {
  MotionCounts counts;
  counts.inliers = static_cast<int>(features.inliers.size());
  for (const std::vector<PointMatch>* matches : {&features.inliers, &features.outliers}) {
    for (const PointMatch& match : *matches) {
      const double moved = Displacement(match) / features.side;
      if (moved <= kStill) ++counts.still;
      if (moved > kStill && moved <= kNearly) ++counts.nearly;
      // Moving features are counted among verified matches alone, where a still part was not what was verified.
      if (moved > kNearly && matches == &features.inliers) ++counts.moving;
    }
  }
  if (features.inliers.size() < kMinForMotion) return counts;
  if (features.homography) {
    const Eigen::Matrix3d map = RefitHomography(*features.homography, features.inliers);
    for (const PointMatch& match : features.inliers) {
      counts.planar += ((map * match.a.homogeneous()).hnormalized() - match.b).norm() <= kOnPlane * features.side;
    }
  }
  const Eigen::Matrix3d epipolar = FitEpipolar(features.inliers);
  std::vector<PointMatch> apart;
  for (const PointMatch& match : features.outliers) {
    if (Displacement(match) > kNearly * features.side && DistanceFromLine(epipolar, match) > kApart * features.side) {
      apart.push_back(match);
    }
  }
  if (apart.size() < static_cast<size_t>(kMinApart)) return counts;
  const int agreeing = LargestAgreement(apart, kOfOneMotion * features.side);
  if (agreeing >= kMinShareApart * static_cast<double>(apart.size())) counts.apart = agreeing;
  return counts;
}

}  // namespace oraclegs
