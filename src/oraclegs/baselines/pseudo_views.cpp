#include "oraclegs/baselines/pseudo_views.h"

#include <cmath>
#include <limits>

#include "oraclegs/core/error.h"
#include "oraclegs/core/rng.h"

namespace oraclegs {
namespace {

using Eigen::Vector3d;

constexpr double kFullTurn = 6.283185307179586;
constexpr uint64_t kDraws = uint64_t{1} << 63;  // counters that the views themselves were not made with

void RequireCameras(const std::vector<Camera>& cameras) {
  if (cameras.empty()) throw UsageError("pseudo views need training views, and there are none; add photos with poses");
}

/// Index of the camera nearest to a place; `other` is skipped unless it is the only one.
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

/// A standard normal number (Box-Muller).
double DrawNormal(Rng* rng) {
  const double radius = std::sqrt(-2 * std::log(1 - rng->Uniform()));
  return radius * std::cos(kFullTurn * rng->Uniform());
}

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

const Camera& DrawPseudoView(const std::vector<Camera>& views, uint64_t seed, int64_t iteration) {
  const Philox draw =
      Philox::Draw(seed, static_cast<uint64_t>(RandomStream::kPseudoViews), kDraws | static_cast<uint64_t>(iteration));
  return views[static_cast<size_t>(draw.Uniform() * static_cast<double>(views.size()))];
}

}  // namespace oraclegs
