#include "oraclegs/camera/camera_path.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <utility>

namespace oraclegs {
namespace {

using Eigen::Vector3d;

constexpr double kTwoPi = 2 * std::numbers::pi;
constexpr int kSpiralTurns = 2;
constexpr double kMaxGap = kTwoPi / 3;  // a wider one is a side that no view shows

bool AllLookTowards(const std::vector<Camera>& cameras, const Vector3d& focus) {
  return std::all_of(cameras.begin(), cameras.end(),
                     [&](const Camera& c) { return c.Forward().dot(focus - c.Center()) > 0; });
}

/// For cameras side by side: by their place along the direction in which they are spread most.
std::vector<size_t> OrderAlongSpread(const std::vector<Camera>& cameras) {
  Vector3d mean = Vector3d::Zero();
  for (const Camera& c : cameras) mean += c.Center() / static_cast<double>(cameras.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Camera& c : cameras) covariance += (c.Center() - mean) * (c.Center() - mean).transpose();
  const Vector3d axis = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvectors().col(2);
  std::vector<size_t> order(cameras.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return axis.dot(cameras[a].Center()) < axis.dot(cameras[b].Center()); });
  return order;
}

/// Where a path through p0 p1 p2 goes at p1, per segment. Catmull-Rom's, but no longer than the shorter segment beside
/// it, so that the path neither loops nor swings out where a long segment meets a short one.
Vector3d Tangent(const Vector3d& p0, const Vector3d& p1, const Vector3d& p2) {
  const Vector3d along = (p2 - p0) / 2;
  const double longest = std::min((p1 - p0).norm(), (p2 - p1).norm());
  return along.norm() > longest ? Vector3d(along * (longest / along.norm())) : along;
}

/// The cameras' distances from the axis `up` through a point, and heights along it.
struct CameraBelt {
  CameraBelt(const std::vector<Camera>& cameras, const Vector3d& focus, const Vector3d& up) {
    low = high = up.dot(cameras.front().Center() - focus);
    for (const Camera& c : cameras) {
      const Vector3d offset = c.Center() - focus;
      const double height = up.dot(offset);
      low = std::min(low, height), high = std::max(high, height);
      mean += height / static_cast<double>(cameras.size());
      radius += (offset - height * up).norm() / static_cast<double>(cameras.size());
    }
  }
  double low = 0, high = 0, mean = 0, radius = 0;
};

/// For views from one side: around their mean, beside and above it as far as half of them go.
std::vector<Eigen::Isometry3d> EllipseBefore(const std::vector<Camera>& cameras, int frames) {
  const Vector3d up = MeanUp(cameras);
  Vector3d mean = Vector3d::Zero(), forward = Vector3d::Zero();
  for (const Camera& c : cameras) {
    mean += c.Center() / static_cast<double>(cameras.size());
    forward += c.Forward();
  }
  Vector3d focus = NearestToAxes(cameras);
  if (!AllLookTowards(cameras, focus)) focus = mean + forward.normalized() * std::max(1e-3, (focus - mean).norm());
  const Vector3d side = forward.cross(up).normalized();
  double wide = 0, high = 0;
  for (const Camera& c : cameras) {
    wide = std::max(wide, std::abs(side.dot(c.Center() - mean)) / 2);
    high = std::max(high, std::abs(up.dot(c.Center() - mean)) / 2);
  }
  std::vector<Eigen::Isometry3d> poses;
  for (int i = 0; i < frames; ++i) {
    const double along = (i + 0.5) / frames, a = kSpiralTurns * kTwoPi * along;
    const Vector3d center = mean + wide * std::cos(a) * side + (high * (2 * along - 1) + high * std::sin(a) / 2) * up;
    poses.push_back(LookAt(center, focus, up));
  }
  return poses;
}

std::vector<Camera> WithPoses(const Camera& intrinsics, const std::vector<Eigen::Isometry3d>& poses) {
  std::vector<Camera> path(poses.size(), intrinsics);
  for (size_t i = 0; i < path.size(); ++i) path[i].cam_from_world = poses[i];
  return path;
}

/// Turns around the axis `up` through what the cameras look at, in which the height goes from one to the other.
struct Turns {
  double from_height = 0, to_height = 0, turns = 1;
};
std::vector<Eigen::Isometry3d> Around(const CameraBelt& belt, const Vector3d& focus, const Vector3d& up,
                                      const Turns& how, int frames) {
  const auto ground = GroundAxes(up);
  std::vector<Eigen::Isometry3d> poses;
  for (int i = 0; i < frames; ++i) {
    const double along = static_cast<double>(i) / frames, a = how.turns * kTwoPi * along;
    const Vector3d side = ground.transpose() * Eigen::Vector2d(std::cos(a), std::sin(a));
    const double height = how.from_height + (how.to_height - how.from_height) * along;
    poses.push_back(LookAt(focus + height * up + belt.radius * side, focus, up));
  }
  return poses;
}

}  // namespace

Vector3d MeanUp(const std::vector<Camera>& cameras) {
  Vector3d up = Vector3d::Zero();
  for (const Camera& c : cameras) up -= c.cam_from_world.linear().row(1).transpose();  // y points down
  return up.norm() > 1e-6 ? up.normalized() : Vector3d(0, 0, 1);
}

Eigen::Matrix<double, 2, 3> GroundAxes(const Vector3d& up) {
  const Vector3d helper = std::abs(up.x()) < 0.9 ? Vector3d::UnitX() : Vector3d::UnitY();
  Eigen::Matrix<double, 2, 3> axes;
  axes.row(0) = (helper - helper.dot(up) * up).normalized();
  axes.row(1) = up.cross(Vector3d(axes.row(0)));
  return axes;
}

CameraRing RingAround(const std::vector<Camera>& cameras, const Vector3d& focus, const Vector3d& up) {
  const auto ground = GroundAxes(up);
  std::vector<double> azimuth;
  for (const Camera& c : cameras) {
    const Eigen::Vector2d p = ground * (c.Center() - focus);
    azimuth.push_back(std::atan2(p.y(), p.x()));
  }
  CameraRing ring;
  ring.order.resize(cameras.size());
  std::iota(ring.order.begin(), ring.order.end(), size_t{0});
  std::stable_sort(ring.order.begin(), ring.order.end(), [&](size_t a, size_t b) { return azimuth[a] < azimuth[b]; });
  size_t first = 0;
  ring.widest_gap = 0;
  for (size_t i = 0; i < ring.order.size(); ++i) {
    const double here = azimuth[ring.order[i]];
    const double before = i > 0 ? azimuth[ring.order[i - 1]] : azimuth[ring.order.back()] - kTwoPi;
    if (here - before <= ring.widest_gap) continue;
    ring.widest_gap = here - before;
    first = i;
  }
  std::rotate(ring.order.begin(), ring.order.begin() + static_cast<std::ptrdiff_t>(first), ring.order.end());
  ring.first_azimuth = azimuth[ring.order.front()];
  ring.all_around = ring.widest_gap < kMaxGap && AllLookTowards(cameras, focus);
  return ring;
}

std::vector<size_t> OrderBesideEachOther(const std::vector<Camera>& cameras) {
  const Vector3d focus = NearestToAxes(cameras);
  if (!AllLookTowards(cameras, focus)) return OrderAlongSpread(cameras);
  return RingAround(cameras, focus, MeanUp(cameras)).order;
}

Eigen::Isometry3d PoseAlong(const std::vector<Camera>& cameras, const std::vector<size_t>& order, double s) {
  const auto last = static_cast<std::ptrdiff_t>(order.size()) - 1;
  const auto i = std::clamp<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(s), 0, std::max<std::ptrdiff_t>(last - 1, 0));
  const auto camera = [&](std::ptrdiff_t k) -> const Camera& {
    return cameras[order[static_cast<size_t>(std::min(k, last))]];
  };
  const Vector3d p1 = camera(i).Center(), p2 = camera(i + 1).Center();
  // At the ends there is no camera beyond: half of the segment, as if the path stood still there.
  const Vector3d leaving = i > 0 ? Tangent(camera(i - 1).Center(), p1, p2) : Vector3d((p2 - p1) / 2);
  const Vector3d arriving = i + 2 <= last ? Tangent(p1, p2, camera(i + 2).Center()) : Vector3d((p2 - p1) / 2);
  const double t = s - static_cast<double>(i), t2 = t * t, t3 = t2 * t;
  const Vector3d center =
      (2 * t3 - 3 * t2 + 1) * p1 + (t3 - 2 * t2 + t) * leaving + (3 * t2 - 2 * t3) * p2 + (t3 - t2) * arriving;
  const Eigen::Quaterniond a(camera(i).cam_from_world.linear()), b(camera(i + 1).cam_from_world.linear());
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = a.slerp(t, b).normalized().toRotationMatrix();
  pose.translation() = -(pose.linear() * center);
  return pose;
}

Eigen::Isometry3d LookAt(const Vector3d& center, const Vector3d& target, const Vector3d& up) {
  const Vector3d z = (target - center).normalized();
  Vector3d x = z.cross(up);
  if (x.norm() < 1e-9) x = z.cross(Vector3d(up.y(), up.z(), up.x()));  // straight up or down: any side will do
  x.normalize();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear().row(0) = x;
  pose.linear().row(1) = z.cross(x);
  pose.linear().row(2) = z;
  pose.translation() = -(pose.linear() * center);
  return pose;
}

Vector3d NearestToAxes(const std::vector<Camera>& cameras) {
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  Vector3d b = Vector3d::Zero(), mean = Vector3d::Zero();
  for (const Camera& c : cameras) {
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - c.Forward() * c.Forward().transpose();
    a += across;
    b += across * c.Center();
    mean += c.Center() / static_cast<double>(cameras.size());
  }
  // Along directions that all axes share nothing decides; the pseudo-inverse then stays at the mean center.
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(a, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Vector3d offset = svd.matrixU().transpose() * (b - a * mean);
  for (int i = 0; i < 3; ++i) {
    const double s = svd.singularValues()[i];
    offset[i] = s > 1e-9 * static_cast<double>(cameras.size()) ? offset[i] / s : 0;
  }
  return mean + svd.matrixV() * offset;
}

std::vector<Camera> OrbitPath(const std::vector<Camera>& cameras, int frames) {
  if (cameras.empty() || frames < 1) throw std::invalid_argument("OrbitPath: needs cameras and at least one frame");
  const Vector3d focus = NearestToAxes(cameras), up = MeanUp(cameras);
  std::vector<Eigen::Isometry3d> poses;
  if (RingAround(cameras, focus, up).all_around) {
    const CameraBelt belt(cameras, focus, up);
    poses = Around(belt, focus, up, {belt.mean, belt.mean, 1}, frames);
  } else {
    const std::vector<size_t> order = OrderBesideEachOther(cameras);
    for (int i = 0; i < frames; ++i) {
      const double there_and_back = 0.5 - 0.5 * std::cos(kTwoPi * i / frames);
      poses.push_back(PoseAlong(cameras, order, there_and_back * static_cast<double>(order.size() - 1)));
    }
  }
  return WithPoses(cameras.front(), poses);
}

std::vector<Camera> SpiralPath(const std::vector<Camera>& cameras, int frames) {
  if (cameras.empty() || frames < 1) throw std::invalid_argument("SpiralPath: needs cameras and at least one frame");
  const Vector3d focus = NearestToAxes(cameras), up = MeanUp(cameras);
  if (!RingAround(cameras, focus, up).all_around) return WithPoses(cameras.front(), EllipseBefore(cameras, frames));
  const CameraBelt belt(cameras, focus, up);
  return WithPoses(cameras.front(), Around(belt, focus, up, {belt.low, belt.high, kSpiralTurns}, frames));
}

std::vector<Camera> InterpolatedPath(const std::vector<Camera>& cameras, int frames) {
  if (cameras.empty() || frames < 1) {
    throw std::invalid_argument("InterpolatedPath: needs cameras and at least one frame");
  }
  std::vector<size_t> order(cameras.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::vector<Eigen::Isometry3d> poses;
  for (int i = 0; i < frames; ++i) {
    const double along = frames > 1 ? static_cast<double>(i) / (frames - 1) : 0;
    poses.push_back(PoseAlong(cameras, order, along * static_cast<double>(cameras.size() - 1)));
  }
  return WithPoses(cameras.front(), poses);
}

}  // namespace oraclegs
