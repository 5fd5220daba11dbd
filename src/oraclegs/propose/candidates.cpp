#include "oraclegs/propose/candidates.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "oraclegs/camera/camera_path.h"
#include "oraclegs/camera/scene_bounds.h"
#include "oraclegs/core/rng.h"
#include "oraclegs/propose/nearest_order.h"

namespace oraclegs {
namespace {

using Eigen::Vector3d;

constexpr double kTwoPi = 2 * std::numbers::pi;
constexpr double kDegree = std::numbers::pi / 180;
constexpr double kRingSpacing = 20 * kDegree;  // between the circles of an orbit
constexpr int kMaxRings = 4, kMinPerRing = 3;
constexpr double kMaxElevation = 80 * kDegree;   // beyond, "up" decides nothing
constexpr double kOneWay = 45 * kDegree;         // of a camera's axis from the mean, in a forward-facing capture
constexpr double kNearDirection = 20 * kDegree;  // views this close decide the distance
constexpr double kSpiralTurns = 2.382;           // no fraction: the same pose does not come twice
constexpr double kMinSpread = 0.25;              // of the widest direction's, so that cameras in a row make a spiral
constexpr double kInwardShare = 0.9;             // the 90th percentile of the spread, as LLFF has it
constexpr double kAside = 0.3;                   // of two neighbors' distance
constexpr int kNeighbors = 3;
constexpr int kStepsPerSegment = 32;  // in measuring a path
constexpr double kKeepOff = 0.125;    // of the spacing: a target this near to a view shows nothing new

std::vector<Camera> WithPoses(const Camera& like, const std::vector<Eigen::Isometry3d>& poses) {
  std::vector<Camera> cameras(poses.size(), like);
  for (size_t i = 0; i < poses.size(); ++i) cameras[i].cam_from_world = poses[i];
  return cameras;
}

/// The training cameras as directions and distances from the point they look at.
class Shell {
 public:
  explicit Shell(const std::vector<Camera>& train)
      : focus_(NearestToAxes(train)),
        up_(MeanUp(train)),
        ground_(GroundAxes(up_)),
        ring_(RingAround(train, focus_, up_)) {
    lowest_ = kMaxElevation, highest_ = -kMaxElevation;
    for (const Camera& c : train) {
      const Vector3d offset = c.Center() - focus_;
      const double distance = offset.norm();
      inwards_ &= distance > 0 && c.Forward().dot(offset) < 0;
      if (!(distance > 0)) continue;
      directions_.push_back(offset / distance);
      distances_.push_back(distance);
      const double elevation = std::asin(std::clamp(up_.dot(directions_.back()), -1., 1.));
      lowest_ = std::min(lowest_, std::clamp(elevation, -kMaxElevation, kMaxElevation));
      highest_ = std::max(highest_, std::clamp(elevation, -kMaxElevation, kMaxElevation));
    }
  }

  bool inwards() const { return inwards_; }
  bool all_around() const { return inwards_ && ring_.all_around; }
  double lowest() const { return lowest_; }
  double highest() const { return highest_; }
  double first_azimuth() const { return ring_.first_azimuth; }
  double azimuth_range() const { return kTwoPi - ring_.widest_gap; }

  Eigen::Isometry3d At(double azimuth, double elevation) const {
    const Vector3d side = ground_.transpose() * Eigen::Vector2d(std::cos(azimuth), std::sin(azimuth));
    const Vector3d direction = std::cos(elevation) * side + std::sin(elevation) * up_;
    return LookAt(focus_ + DistanceTowards(direction) * direction, focus_, up_);
  }

 private:
  /// Weighted mean distance of the views in this direction, since rooms and tables are not round.
  double DistanceTowards(const Vector3d& direction) const {
    double sum = 0, weights = 0;
    for (size_t i = 0; i < directions_.size(); ++i) {
      const double angle = std::acos(std::clamp(direction.dot(directions_[i]), -1., 1.)) / kNearDirection;
      const double weight = std::exp(-angle * angle) + 1e-6;
      sum += weight * distances_[i], weights += weight;
    }
    return sum / weights;
  }

  Vector3d focus_, up_;
  Eigen::Matrix<double, 2, 3> ground_;
  CameraRing ring_;
  std::vector<Vector3d> directions_;
  std::vector<double> distances_;
  double lowest_ = 0, highest_ = 0;
  bool inwards_ = true;
};

/// Length along a path through cameras, from center to center; the angle turned for a pure rotation.
class PathLength {
 public:
  PathLength(const std::vector<Camera>& train, const std::vector<size_t>& order) {
    const size_t steps = kStepsPerSegment * (order.size() - 1);
    std::vector<double> turned{0};
    lengths_ = {0};
    Camera before = train[order[0]];
    for (size_t i = 1; i <= steps; ++i) {
      Camera here = before;
      here.cam_from_world = PoseAlong(train, order, static_cast<double>(i) / kStepsPerSegment);
      lengths_.push_back(lengths_.back() + (here.Center() - before.Center()).norm());
      turned.push_back(turned.back() + TurnBetween(here, before));
      before = here;
    }
    const double rounding = 1e-9 * (1 + train[order[0]].Center().norm());
    if (!(lengths_.back() > rounding)) lengths_ = turned;
  }

  double total() const { return lengths_.back(); }

  /// Parameter of PoseAlong at `length` along the path, moved off the cameras.
  double Place(double length, double spacing) const {
    const double kept = OffTheCameras(length, spacing);
    const auto above = std::upper_bound(lengths_.begin() + 1, lengths_.end() - 1, kept);
    const double t = (kept - *(above - 1)) / (*above - *(above - 1));
    return (static_cast<double>(above - lengths_.begin()) - 1 + t) / kStepsPerSegment;
  }

 private:
  double OffTheCameras(double length, double spacing) const {
    for (size_t k = 0; k < lengths_.size(); k += kStepsPerSegment) {
      const double camera = lengths_[k];
      if (std::abs(length - camera) >= kKeepOff * spacing) continue;
      const bool after = (length >= camera && k + 1 < lengths_.size()) || k == 0;
      const double gap = after ? lengths_[k + kStepsPerSegment] - camera : camera - lengths_[k - kStepsPerSegment];
      const double away = std::min(kKeepOff * spacing, gap / 2);
      if (!(away > 0)) continue;  // the next camera stands in the same place
      return after ? camera + away : camera - away;
    }
    return length;
  }

  std::vector<double> lengths_;
};

std::vector<Camera> AlongPath(const std::vector<Camera>& train, const std::vector<size_t>& order, int count) {
  if (train.size() < 2 || count < 1) return {};
  const PathLength path(train, order);
  if (!(path.total() > 1e-9)) return {};
  const double spacing = path.total() / count;
  std::vector<Eigen::Isometry3d> poses;
  for (int i = 0; i < count; ++i) poses.push_back(PoseAlong(train, order, path.Place((i + 0.5) * spacing, spacing)));
  return WithPoses(train.front(), poses);
}

Vector3d MeanForward(const std::vector<Camera>& train) {
  Vector3d mean = Vector3d::Zero();
  for (const Camera& c : train) mean += c.Forward();
  return mean.norm() > 1e-6 ? mean.normalized() : train.front().Forward();
}

bool LookOneWay(const std::vector<Camera>& train) {
  const Vector3d mean = MeanForward(train);
  return std::all_of(train.begin(), train.end(),
                     [&](const Camera& c) { return c.Forward().dot(mean) > std::cos(kOneWay); });
}

std::vector<Eigen::Isometry3d> SpiralAroundMean(const std::vector<Camera>& train, int count) {
  Vector3d mean = Vector3d::Zero();
  for (const Camera& c : train) mean += c.Center() / static_cast<double>(train.size());
  const Vector3d up = MeanUp(train);
  const Ball subject = LookedAt(train);
  const Eigen::Isometry3d pose = LookAt(mean, mean + MeanForward(train), up);
  Vector3d spread = Vector3d::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> offsets;
    for (const Camera& c : train) offsets.push_back(std::abs((pose * c.Center())[axis]));
    std::sort(offsets.begin(), offsets.end());
    spread[axis] = offsets[static_cast<size_t>(kInwardShare * static_cast<double>(offsets.size() - 1) + 0.5)];
  }
  const double widest = spread.maxCoeff();
  if (!(widest > 1e-9 * (1 + mean.norm()))) return {};
  for (int axis = 0; axis < 2; ++axis) spread[axis] = std::max(spread[axis], kMinSpread * widest);
  std::vector<Eigen::Isometry3d> poses;
  for (int i = 0; i < count; ++i) {
    const double t = (i + 0.5) / count, angle = kTwoPi * kSpiralTurns * t;
    const Vector3d offset(spread.x() * std::cos(angle), spread.y() * std::sin(angle), spread.z() * std::sin(angle / 2));
    const Vector3d center = pose.inverse() * offset;
    // Parallel axes do not intersect: the focus is then as far ahead of the mean as LookedAt guesses.
    const double ahead = std::max((subject.center - mean).dot(MeanForward(train)), 2 * widest);
    poses.push_back(LookAt(center, mean + ahead * MeanForward(train), up));
  }
  return poses;
}

}  // namespace

std::vector<Camera> OrbitCandidates(const std::vector<Camera>& train, int count) {
  const Shell shell(train);
  if (!shell.all_around()) return AlongPath(train, OrderBesideEachOther(train), count);
  const double range = shell.highest() - shell.lowest();
  const int rings =
      std::clamp(1 + static_cast<int>(range / kRingSpacing + 0.5), 1, std::clamp(count / kMinPerRing, 1, kMaxRings));
  std::vector<Eigen::Isometry3d> poses;
  for (int r = 0; r < rings; ++r) {
    const int on_ring = count * (r + 1) / rings - count * r / rings;
    for (int i = 0; i < on_ring; ++i) {
      const double azimuth = kTwoPi * (i + static_cast<double>(r) / rings) / on_ring;
      poses.push_back(shell.At(azimuth, shell.lowest() + range * (r + 0.5) / rings));
    }
  }
  return WithPoses(train.front(), poses);
}

std::vector<Camera> SpiralCandidates(const std::vector<Camera>& train, int count) {
  if (LookOneWay(train)) return WithPoses(train.front(), SpiralAroundMean(train, count));
  const Shell shell(train);
  if (!shell.inwards()) return AlongPath(train, OrderBesideEachOther(train), count);
  const double range = shell.highest() - shell.lowest();
  std::vector<Eigen::Isometry3d> poses;
  for (int i = 0; i < count; ++i) {
    const double t = (i + 0.5) / count;
    const double rises = shell.all_around() ? 1 : kSpiralTurns;  // over an arc the elevation swings instead
    const double azimuth =
        shell.first_azimuth() + (shell.all_around() ? kTwoPi * kSpiralTurns : shell.azimuth_range()) * t;
    poses.push_back(shell.At(azimuth, shell.lowest() + range * (0.5 - 0.5 * std::cos(kTwoPi * rises * t))));
  }
  return WithPoses(train.front(), poses);
}

std::vector<Camera> InterpolatedCandidates(const std::vector<Camera>& train, int count) {
  return AlongPath(train, NearestOrder(train), count);
}

std::vector<Camera> JitteredCandidates(const std::vector<Camera>& train, int count, uint64_t seed) {
  if (train.size() < 2) return {};
  Rng rng(seed, RandomStream::kTargets);
  std::vector<Eigen::Isometry3d> poses;
  for (int i = 0; i < count; ++i) {
    const Camera& a = train[static_cast<size_t>(rng.Index(static_cast<int64_t>(train.size())))];
    std::vector<size_t> others(train.size());
    std::iota(others.begin(), others.end(), size_t{0});
    std::stable_sort(others.begin(), others.end(), [&](size_t p, size_t q) {
      return (train[p].Center() - a.Center()).norm() < (train[q].Center() - a.Center()).norm();
    });
    const size_t near = std::min<size_t>(kNeighbors, train.size() - 1);  // others[0] is the camera itself
    const Camera& b = train[others[1 + static_cast<size_t>(rng.Index(static_cast<int64_t>(near)))]];
    const double t = rng.Uniform(0.2, 0.8), reach = kAside * (b.Center() - a.Center()).norm() / std::sqrt(3.);
    Vector3d center = (1 - t) * a.Center() + t * b.Center();
    for (int axis = 0; axis < 3; ++axis) center[axis] += rng.Uniform(-reach, reach);
    const Eigen::Quaterniond from(a.cam_from_world.linear()), to(b.cam_from_world.linear());
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = from.slerp(t, to).normalized().toRotationMatrix();
    pose.translation() = -(pose.linear() * center);
    poses.push_back(pose);
  }
  return WithPoses(train.front(), poses);
}

}  // namespace oraclegs
