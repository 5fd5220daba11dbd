#include "oraclegs/train/baselines/pseudo_views.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "oraclegs/camera/camera_path.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/rng.h"

namespace oraclegs {
namespace {

using Eigen::Vector3d;

constexpr double kFullTurn = 6.283185307179586;

void RequireCameras(const std::vector<Camera>& cameras) {
  if (cameras.empty()) throw UsageError("pseudo views need training views, and there are none; add photos with poses");
}

/// Nearest camera to a place, without camera `other` where there is another one.
size_t NearestCamera(const std::vector<Camera>& cameras, const Vector3d& place, size_t other) {
  size_t nearest = other < cameras.size() ? other : 0;
  double best = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < cameras.size(); ++i) {
    const double d2 = (cameras[i].Center() - place).squaredNorm();
    if (i == other || d2 >= best) continue;
    best = d2;
    nearest = i;
  }
  return nearest;
}

Camera CameraAt(const std::vector<Camera>& cameras, const Eigen::Isometry3d& cam_from_world) {
  Camera camera;
  camera.cam_from_world = cam_from_world;
  camera = cameras[NearestCamera(cameras, camera.Center(), cameras.size())];
  camera.cam_from_world = cam_from_world;
  return camera;
}

/// By Box and Muller.
double DrawNormal(Rng* rng) {
  const double radius = std::sqrt(-2 * std::log(1 - rng->Uniform()));
  return radius * std::cos(kFullTurn * rng->Uniform());
}

/// Between the numbers in order by linear interpolation; p in [0, 1].
double PercentileOf(std::vector<double> numbers, double p) {
  std::sort(numbers.begin(), numbers.end());
  const double at = p * static_cast<double>(numbers.size() - 1);
  const auto below = static_cast<size_t>(at);
  const size_t above = std::min(below + 1, numbers.size() - 1);
  return numbers[below] + (at - static_cast<double>(below)) * (numbers[above] - numbers[below]);
}

Vector3d MeanCenter(const std::vector<Camera>& cameras) {
  Vector3d sum = Vector3d::Zero();
  for (const Camera& camera : cameras) sum += camera.Center();
  return sum / static_cast<double>(cameras.size());
}

/// Rows: the directions of the largest, second and least spread of the camera centers; the last one points upwards, and
/// the three are right-handed.
Eigen::Matrix3d PrincipalAxes(const std::vector<Camera>& cameras, const Vector3d& mean, const Vector3d& up) {
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Camera& camera : cameras) spread += (camera.Center() - mean) * (camera.Center() - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);  // ascending
  Vector3d first = solver.eigenvectors().col(2), last = solver.eigenvectors().col(0);
  int largest = 0;
  first.cwiseAbs().maxCoeff(&largest);
  if (first[largest] < 0) first = -first;  // a solver may return either
  if (last.dot(up) < 0) last = -last;
  Eigen::Matrix3d axes;
  axes.row(0) = first;
  axes.row(1) = last.cross(first);
  axes.row(2) = last;
  return axes;
}

/// The ellipse on which pseudo views lie, in coordinates along `axes` from `mean`.
struct PseudoEllipse {
  Eigen::Matrix3d axes;
  Vector3d mean;
  Vector3d focus;    ///< along the axes, as the others
  double radius[2];  ///< around the focus
  double low = 0, high = 0;

  explicit PseudoEllipse(const std::vector<Camera>& cameras) : mean(MeanCenter(cameras)) {
    axes = PrincipalAxes(cameras, mean, MeanUp(cameras));
    focus = axes * (NearestToAxes(cameras) - mean);
    std::vector<double> away[2], heights;
    for (const Camera& camera : cameras) {
      const Vector3d p = axes * (camera.Center() - mean);
      for (int axis : {0, 1}) away[axis].push_back(std::abs(p[axis] - focus[axis]));
      heights.push_back(p.z());
    }
    for (int axis : {0, 1}) radius[axis] = PercentileOf(away[axis], 0.9);
    constexpr double kHeightVariation = 0.1;
    low = kHeightVariation * PercentileOf(heights, 0.1);
    high = kHeightVariation * PercentileOf(heights, 0.9);
  }

  Vector3d At(double angle) const {
    const double c = std::cos(angle), s = std::sin(angle);
    return mean + axes.transpose() * Vector3d(focus.x() + radius[0] * c, focus.y() + radius[1] * s,
                                              low + (high - low) * (0.5 * c + 0.5));
  }
  /// The axis nearest to this direction, pointing as it does.
  Vector3d NearestAxis(const Vector3d& up) const {
    int axis = 0;
    const Vector3d along = axes * up;
    along.cwiseAbs().maxCoeff(&axis);
    return axes.row(axis).transpose() * (along[axis] < 0 ? -1 : 1);
  }
};

}  // namespace

std::vector<Camera> PseudoViewsBetween(const std::vector<Camera>& cameras, int64_t count, uint64_t seed, double noise) {
  RequireCameras(cameras);
  std::vector<size_t> nearest;
  for (size_t i = 0; i < cameras.size(); ++i) nearest.push_back(NearestCamera(cameras, cameras[i].Center(), i));
  Rng rng(seed, RandomStream::kPseudoViews);
  std::vector<Camera> views;
  for (int64_t k = 0; k < count; ++k) {
    const auto from = static_cast<size_t>(rng.Index(static_cast<int64_t>(cameras.size())));
    const Camera &a = cameras[from], &b = cameras[nearest[from]];
    const Vector3d way = b.Center() - a.Center();
    Vector3d center = a.Center() + rng.Uniform() * way;
    for (int axis = 0; axis < 3; ++axis) center[axis] += noise * way.norm() * DrawNormal(&rng);
    const Eigen::Quaterniond qa(a.cam_from_world.linear()), qb(b.cam_from_world.linear());
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = qa.slerp(0.5, qb).normalized().toRotationMatrix();
    pose.translation() = -(pose.linear() * center);
    views.push_back(CameraAt(cameras, pose));
  }
  return views;
}

std::vector<Camera> PseudoViewsInBox(const std::vector<Camera>& cameras, const DepthBounds& bounds, int64_t count,
                                     uint64_t seed) {
  RequireCameras(cameras);
  if (!(bounds.near_depth > 0 && bounds.near_depth <= bounds.far_depth)) {
    throw UsageError("pseudo views from depths {} to {}: give a near depth above 0 and a far one no less",
                     bounds.near_depth, bounds.far_depth);
  }
  const Vector3d mean = MeanCenter(cameras), up = MeanUp(cameras);
  Vector3d forward = Vector3d::Zero();
  for (const Camera& camera : cameras) forward += camera.Forward();
  const Eigen::Matrix3d axes = LookAt(mean, mean + forward, up).linear();
  Vector3d half = Vector3d::Zero();
  for (const Camera& camera : cameras) half = half.cwiseMax((axes * (camera.Center() - mean)).cwiseAbs());
  const double focal = 1 / (0.25 / (0.9 * bounds.near_depth) + 0.75 / (5 * bounds.far_depth));
  const Vector3d target = mean + focal * axes.row(2).transpose();
  Rng rng(seed, RandomStream::kPseudoViews);
  std::vector<Camera> views;
  for (int64_t k = 0; k < count; ++k) {
    Vector3d p;
    for (int axis = 0; axis < 3; ++axis) p[axis] = half[axis] * rng.Uniform(-1, 1);
    views.push_back(CameraAt(cameras, LookAt(mean + axes.transpose() * p, target, up)));
  }
  return views;
}

std::vector<Camera> PseudoViewsOnEllipse(const std::vector<Camera>& cameras, int64_t count, uint64_t seed) {
  RequireCameras(cameras);
  const PseudoEllipse ellipse(cameras);
  const Vector3d up = ellipse.NearestAxis(MeanUp(cameras)), target = NearestToAxes(cameras);
  Rng rng(seed, RandomStream::kPseudoViews);
  std::vector<Camera> views;
  for (int64_t k = 0; k < count; ++k) {
    views.push_back(CameraAt(cameras, LookAt(ellipse.At(kFullTurn * rng.Uniform()), target, up)));
  }
  return views;
}

}  // namespace oraclegs
