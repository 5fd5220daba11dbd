#include "oraclegs/propose/target_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "oraclegs/core/parallel.h"
#include "oraclegs/core/statistics.h"
#include "oraclegs/propose/nearest_order.h"

namespace oraclegs {
namespace {

constexpr double kSamePlaceShare = 1e-3;
constexpr double kSameTurn = 0.1 * std::numbers::pi / 180;
constexpr size_t kMaxPoints = 20000, kMinPoints = 100;
constexpr double kInsideShare = 0.25;      // of the smallest median depth
constexpr double kOwnDistanceShare = 0.8;  // of the smallest distance of a training camera from geometry
constexpr int kInsidePoints = 5;           // fewer may be outliers
constexpr int kGrid = 16;
constexpr double kMinCoveredShare = 0.1, kMinShareOfMedian = 0.5;
constexpr int kOcclusionGrid = 48;
constexpr float kBehind = 1.2f;

struct InImage {
  float u, v, depth;  // u, v in [0, 1) of the image; depth 0 where it is not seen
};

InImage ProjectFacing(const DensePoint& point, const Camera& camera, const Eigen::Matrix<float, 3, 4>& pose,
                      const Eigen::Vector3f& center) {
  const Eigen::Vector3f p = pose.leftCols<3>() * point.xyz + pose.col(3);
  if (!(p.z() > 0) || point.normal.dot(center - point.xyz) < 0) return {0, 0, 0};  // a zero normal faces everywhere
  const float u = (static_cast<float>(camera.fx) * p.x() / p.z() + static_cast<float>(camera.cx)) /
                  static_cast<float>(camera.width);
  const float v = (static_cast<float>(camera.fy) * p.y() / p.z() + static_cast<float>(camera.cy)) /
                  static_cast<float>(camera.height);
  if (!(u >= 0 && u < 1 && v >= 0 && v < 1)) return {0, 0, 0};
  return {u, v, p.z()};
}

std::vector<InImage> ProjectAll(const std::vector<DensePoint>& points, const Camera& camera) {
  const Eigen::Matrix<float, 3, 4> pose = camera.cam_from_world.matrix().topRows<3>().cast<float>();
  const Eigen::Vector3f center = camera.Center().cast<float>();
  std::vector<InImage> projected;
  projected.reserve(points.size());
  for (const DensePoint& point : points) projected.push_back(ProjectFacing(point, camera, pose, center));
  return projected;
}

size_t Cell(const InImage& p, int grid) {
  return static_cast<size_t>(static_cast<int>(p.v * static_cast<float>(grid)) * grid +
                             static_cast<int>(p.u * static_cast<float>(grid)));
}

double CoveredShare(const std::vector<DensePoint>& points, const Camera& camera) {
  std::array<bool, kGrid * kGrid> hit{};
  for (const InImage& p : ProjectAll(points, camera)) {
    if (p.depth > 0) hit[Cell(p, kGrid)] = true;
  }
  return static_cast<double>(std::count(hit.begin(), hit.end(), true)) / (kGrid * kGrid);
}

/// Median depth of the visible points; infinite without any.
double MedianDepth(const std::vector<DensePoint>& points, const Camera& camera) {
  std::vector<float> depths;
  for (const InImage& p : ProjectAll(points, camera)) {
    if (p.depth > 0) depths.push_back(p.depth);
  }
  return depths.empty() ? std::numeric_limits<double>::infinity() : static_cast<double>(UpperMedian(&depths));
}

double MedianDepth(const DepthMap& map) {
  std::vector<float> inverse;
  for (size_t i = 0; i < map.size(); ++i) {
    if (map.confidence[i] >= kConfident && map.inv_depth[i] > 0) inverse.push_back(map.inv_depth[i]);
  }
  return inverse.empty() ? std::numeric_limits<double>::infinity() : 1 / static_cast<double>(UpperMedian(&inverse));
}

/// Distance of the kInsidePoints-th nearest point.
double ClearDistance(const std::vector<DensePoint>& points, const Camera& camera) {
  std::vector<float> squares;
  const Eigen::Vector3f center = camera.Center().cast<float>();
  for (const DensePoint& point : points) squares.push_back((point.xyz - center).squaredNorm());
  std::nth_element(squares.begin(), squares.begin() + kInsidePoints - 1, squares.end());
  return std::sqrt(static_cast<double>(squares[kInsidePoints - 1]));
}

}  // namespace

double SamePlace(const std::vector<Camera>& train) {
  double sum = 0, farthest = 0;
  for (size_t i = 0; i < train.size(); ++i) {
    double nearest = std::numeric_limits<double>::infinity();
    for (size_t j = 0; j < train.size(); ++j) {
      if (j != i) nearest = std::min(nearest, (train[i].Center() - train[j].Center()).norm());
    }
    sum += std::isfinite(nearest) ? nearest : 0;
    farthest = std::max(farthest, train[i].Center().norm());
  }
  const double rounding = 1e-9 * (1 + farthest);
  return train.empty() ? rounding : std::max(rounding, kSamePlaceShare * sum / static_cast<double>(train.size()));
}

bool PoseSet::Has(const Camera& camera) const {
  const Eigen::Vector3d center = camera.Center();
  return std::any_of(cameras_.begin(), cameras_.end(), [&](const Camera& known) {
    return (known.Center() - center).norm() <= same_place_ && TurnBetween(known, camera) <= kSameTurn;
  });
}

std::vector<DensePoint> EvenSample(const std::vector<DensePoint>& points, size_t budget) {
  if (points.size() <= budget) return points;
  std::vector<DensePoint> sample;
  sample.reserve(budget);
  for (size_t i = 0; i < budget; ++i) sample.push_back(points[i * points.size() / budget]);
  return sample;
}

std::vector<int> PointsSeen(const std::vector<DensePoint>& points, const Camera& camera) {
  const std::vector<InImage> projected = ProjectAll(points, camera);
  std::array<float, kOcclusionGrid * kOcclusionGrid> nearest;
  nearest.fill(std::numeric_limits<float>::infinity());
  for (const InImage& p : projected) {
    if (p.depth > 0) nearest[Cell(p, kOcclusionGrid)] = std::min(nearest[Cell(p, kOcclusionGrid)], p.depth);
  }
  std::vector<int> seen;
  for (size_t i = 0; i < projected.size(); ++i) {
    const InImage& p = projected[i];
    if (p.depth > 0 && p.depth <= kBehind * nearest[Cell(p, kOcclusionGrid)]) seen.push_back(static_cast<int>(i));
  }
  return seen;
}

TargetCheck::TargetCheck(const TrajectoryRequest& request)
    : same_place_(SamePlace(request.train)),
      test_(request.test, same_place_),
      train_(request.train, same_place_),
      real_({}, same_place_) {
  for (const Target& spare : request.spare) {
    if (request.sees_anything) real_.Add(spare.camera);
  }
  if (request.points == nullptr || request.points->size() < kMinPoints) return;
  points_ = EvenSample(*request.points, kMaxPoints);
  const size_t n = request.train.size();
  std::vector<double> depth(n), clear(n), share(n);
  ParallelFor(static_cast<int64_t>(n), [&](int64_t task) {
    const auto i = static_cast<size_t>(task);
    const Camera& camera = request.train[i];
    const bool has_map = request.maps != nullptr && request.maps->size() == n;
    depth[i] = has_map ? MedianDepth((*request.maps)[i]) : MedianDepth(points_, camera);
    clear[i] = ClearDistance(points_, camera);
    share[i] = CoveredShare(points_, camera);
  });
  // A view taken close to something shows that a camera fits there.
  nearest_ = std::min(kInsideShare * *std::min_element(depth.begin(), depth.end()),
                      kOwnDistanceShare * *std::min_element(clear.begin(), clear.end()));
  // An object before a plain background covers little of the image.
  if (request.sees_anything) return;
  min_share_ = std::min(kMinCoveredShare, kMinShareOfMedian * UpperMedian(&share));
}

bool TargetCheck::IsInsideGeometry(const Camera& camera) const {
  const Eigen::Vector3f center = camera.Center().cast<float>();
  const auto square = static_cast<float>(nearest_ * nearest_);
  int near = 0;
  for (const DensePoint& point : points_) near += (point.xyz - center).squaredNorm() < square ? 1 : 0;
  return near >= kInsidePoints;
}

Verdict TargetCheck::Classify(const Camera& camera) const {
  if (test_.Has(camera)) return Verdict::kTestPose;
  if (train_.Has(camera)) return Verdict::kKnownPose;
  if (points_.empty()) return Verdict::kGood;
  if (!real_.Has(camera) && IsInsideGeometry(camera)) return Verdict::kInsideGeometry;
  if (CoveredShare(points_, camera) < min_share_) return Verdict::kSeesNothing;
  return Verdict::kGood;
}

}  // namespace oraclegs
