#include "oraclegs/scene/frame.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "oraclegs/camera/camera_path.h"
#include "oraclegs/camera/scene_bounds.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/options.h"
#include "oraclegs/core/statistics.h"
#include "oraclegs/core/text.h"
#include "oraclegs/scene/gps_scale.h"
#include "oraclegs/scene/view_list.h"

namespace oraclegs {
namespace {

constexpr double kMinTurn = 0.02;     // variance of the images' horizontal sides across the weaker of two directions
constexpr double kMinUpCosine = 0.5;  // between the two kinds of up
constexpr double kMaxTiltCosine = 0.966;    // 15 degrees between a floor's normal and the cameras' mean up
constexpr double kPlaneThickness = 0.01;    // of the median distance of the points from the center
constexpr double kMinPlaneFraction = 0.15;  // of the points, on a floor or table worth leveling by
constexpr double kUsualDistance = 4;        // units; that of the cameras of NeRF Synthetic
constexpr double kFarFromOrigin =
    1000;  // usual distances: a float is 0.06 px coarse there, at a focal length of 1000 px
constexpr double kMinUsualDistance = 0.5, kMaxUsualDistance = 4000;  // units in which the near plane hides nothing
constexpr int kPlaneTries = 500;
constexpr size_t kMinPlanePoints = 50;

std::vector<Camera> CamerasOf(const Scene& scene) {
  std::vector<Camera> cameras;
  for (const SceneView& view : scene.views) {
    Camera camera;
    camera.cam_from_world = view.cam_from_world.value();
    cameras.push_back(camera);
  }
  return cameras;
}

/// Cameras are rarely rolled, so that the horizontal sides of their images span the ground. Their mean up instead is
/// off by as much as they look down. Nothing where the sides lie along one line or cameras look straight down.
std::optional<Eigen::Vector3d> UpOfSides(const std::vector<Camera>& cameras) {
  const Eigen::Vector3d mean = MeanUp(cameras);
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  for (const Camera& camera : cameras) {
    const Eigen::Vector3d side = camera.cam_from_world.linear().row(0).transpose();
    squares += side * side.transpose() / static_cast<double>(cameras.size());
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> spread(squares);
  const Eigen::Vector3d across = spread.eigenvectors().col(0);
  const Eigen::Vector3d up = across * (across.dot(mean) < 0 ? -1 : 1);
  return spread.eigenvalues()[1] > kMinTurn && up.dot(mean) > kMinUpCosine ? std::optional(up) : std::nullopt;
}

double MedianDistance(const std::vector<ScenePoint>& points, const Eigen::Vector3d& center) {
  std::vector<double> distances;
  for (const ScenePoint& p : points) distances.push_back((p.xyz - center).norm());
  return UpperMedian(&distances);
}

/// Unit, towards `up`; of the plane through three points that most points lie near, of those about level.
std::optional<Eigen::Vector3d> FloorNormal(const std::vector<ScenePoint>& points, const Eigen::Vector3d& up,
                                           const Eigen::Vector3d& center) {
  if (points.size() < kMinPlanePoints) return std::nullopt;
  const double thickness = kPlaneThickness * MedianDistance(points, center);
  const auto near = [&](const Eigen::Vector3d& p, const Eigen::Vector3d& normal, double offset) {
    return std::abs(normal.dot(p) - offset) < thickness;
  };
  std::minstd_rand random;  // its numbers are laid down by the standard
  const auto draw = [&] { return points[random() % points.size()].xyz; };
  Eigen::Vector3d best = up, on_best = center;
  size_t most = 0;
  for (int k = 0; k < kPlaneTries; ++k) {
    const Eigen::Vector3d a = draw(), b = draw(), c = draw();
    Eigen::Vector3d normal = (b - a).cross(c - a);
    if (!(normal.norm() > 0)) continue;
    normal = normal.normalized() * (normal.dot(up) < 0 ? -1 : 1);
    if (normal.dot(up) < kMaxTiltCosine) continue;
    size_t count = 0;
    for (const ScenePoint& p : points) count += near(p.xyz, normal, normal.dot(a)) ? 1 : 0;
    if (count > most) most = count, best = normal, on_best = a;
  }
  if (static_cast<double>(most) < kMinPlaneFraction * static_cast<double>(points.size())) return std::nullopt;
  // The plane that fits all of them: the direction in which they vary least.
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  for (const ScenePoint& p : points) {
    if (!near(p.xyz, best, best.dot(on_best))) continue;
    const Eigen::Vector3d d = p.xyz - on_best;
    mean += d, squares += d * d.transpose();
  }
  mean /= static_cast<double>(most);
  const Eigen::Matrix3d spread = squares / static_cast<double>(most) - mean * mean.transpose();
  const Eigen::Vector3d normal = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors().col(0);
  return normal * (normal.dot(up) < 0 ? -1 : 1);
}

/// The parts of "A,B=0.35" or "0.35".
struct Scale {
  std::string views;  ///< "" where a number stands alone
  double meters = 0;
};

Scale ParseScale(const std::string& text) {
  const size_t equals = text.rfind('=');
  Scale scale{equals == std::string::npos ? "" : text.substr(0, equals), 0};
  SetOption("scale", equals == std::string::npos ? text : text.substr(equals + 1), &scale.meters);
  const bool two = scale.views.empty() ? equals == std::string::npos : SplitTrimmed(scale.views, ',').size() == 2;
  if (!(scale.meters > 0) || !std::isfinite(scale.meters) || !two) {
    throw UsageError("--scale is '{}', must be the meters of a unit, or two photos and their distance, as A,B=0.35",
                     text);
  }
  return scale;
}

/// Names alone: the place of a view among the others changes when a photo cannot be used.
void RequireNames(const Scale& scale, const std::string& text) {
  for (const std::string& name : SplitTrimmed(scale.views, ',')) {
    if (name.starts_with(':')) throw UsageError("--scale is '{}', must name two photos, as A,B=0.35", text);
  }
}

std::vector<int> ViewsOf(const Scene& scene, const Scale& scale, const std::string& text) {
  std::vector<int> views = NamedViews(scene, "--scale", scale.views);
  if (views.size() != 2) throw UsageError("--scale is '{}', must name two photos, as A,B=0.35", text);
  return views;
}

/// The views that --scale names, which must have a pose.
std::vector<int> FoundViewsOf(const Scene& scene, const Scale& scale, const std::string& text) {
  try {
    return ViewsOf(scene, scale, text);
  } catch (const InputError&) {
    throw InputError(
        "--scale {}: the camera of one of these photos was not found (sfm/registration.json says why); name two others",
        text);
  }
}

Similarity FromFound(const SceneFrame& frame) { return {frame.rotation, frame.scale, -frame.scale * frame.center}; }

double MedianDistance(const std::vector<Camera>& cameras, const Eigen::Vector3d& center) {
  std::vector<double> distances;
  for (const Camera& camera : cameras) distances.push_back((camera.Center() - center).norm());
  return Median(&distances);
}

/// Rounded to a power of ten that the distance is between one and ten of, so that people can read and type it.
Eigen::Vector3d Rounded(const Eigen::Vector3d& center, double distance) {
  // A number of steps is divided by 10 rather than multiplied by 0.1, which no double is. Plus 0 makes 0 of -0.
  const double exponent = std::floor(std::log10(distance)), power = std::pow(10, std::abs(exponent));
  return center.unaryExpr([&](double value) {
    return (exponent < 0 ? std::round(value * power) / power : std::round(value / power) * power) + 0.;
  });
}

}  // namespace

SceneFrame LevelFrame(const Scene& scene) {
  const std::vector<Camera> cameras = CamerasOf(scene);
  const Eigen::Vector3d center = LookedAt(cameras).center;
  std::optional<Eigen::Vector3d> known_up = UpOfSides(cameras);
  if (!known_up) known_up = UpByGps(scene);
  const Eigen::Vector3d up = known_up.value_or(MeanUp(cameras));
  SceneFrame frame;
  frame.is_level = true;
  const Eigen::Vector3d level_up = FloorNormal(scene.points, up, center).value_or(up);
  frame.rotation = Eigen::Quaterniond::FromTwoVectors(level_up, -Eigen::Vector3d::UnitY()).toRotationMatrix();
  frame.center = frame.rotation * center;
  if (const double usual = MedianDistance(cameras, center); usual > 0) frame.scale = kUsualDistance / usual;
  return frame;
}

SceneFrame NormalFrame(const Scene& scene, const std::vector<int>& views) {
  SceneFrame frame;
  frame.is_given = true;
  if (views.empty()) return frame;
  std::vector<Camera> cameras;
  for (const int v : views) {
    cameras.emplace_back().cam_from_world = scene.views[static_cast<size_t>(v)].cam_from_world.value();
  }
  // Beside the first camera: far from the origin the digits of what the cameras look at would be lost.
  const Eigen::Vector3d first = cameras.front().Center();
  for (Camera& camera : cameras) {
    camera.cam_from_world.translation() = -(camera.cam_from_world.linear() * (camera.Center() - first));
  }
  const Eigen::Vector3d center = LookedAt(cameras).center;
  frame.center = first + center;
  const double usual = MedianDistance(cameras, center);
  if (!(usual > 0)) return frame;
  frame.scale = kUsualDistance / usual;
  if (frame.center.norm() > kFarFromOrigin * usual) frame.offset = Rounded(frame.center, usual);
  return frame;
}

std::string WhyUnitsDoNotFit(const SceneFrame& frame) {
  const double usual = kUsualDistance / frame.scale;
  if (usual < kMinUsualDistance) {
    return fmt::format("the cameras stand {:.2g} units from what they look at, and what is nearer than 0.2 is not seen",
                       usual);
  }
  if (usual > kMaxUsualDistance) {
    return fmt::format("the cameras stand {:.2g} units from what they look at, too far for the rates of the method",
                       usual);
  }
  if (!frame.offset.isZero(0)) {
    return fmt::format("the scene lies {:.2g} units from its origin, where positions of 32 bits are too coarse",
                       frame.center.norm());
  }
  return "";
}

Similarity RunFromScene(const SceneFrame& frame) { return frame.is_given ? FromFound(frame) : Similarity(); }

Similarity WrittenFromRun(const SceneFrame& frame) {
  if (!frame.is_given) return {};
  Similarity written;
  written.scale = 1 / frame.scale;
  written.translation = frame.center - frame.offset;
  return written;
}

void CheckScale(const std::string& text) {
  if (!text.empty()) RequireNames(ParseScale(text), text);
}

void CheckScale(const Scene& scene, const std::string& text) {
  if (text.empty()) return;
  const Scale scale = ParseScale(text);
  if (!scale.views.empty()) ViewsOf(scene, scale, text);
}

std::optional<double> UnitMeters(const Scene& scene, const std::string& text, bool arbitrary) {
  if (text.empty()) return std::nullopt;
  const Scale scale = ParseScale(text);
  if (scale.views.empty()) {
    if (!arbitrary) return scale.meters;
    throw UsageError(
        "--scale is '{}', but units are arbitrary where poses are found; name two photos and their distance in meters, "
        "as A,B=0.35",
        text);
  }
  const std::vector<int> views = arbitrary ? FoundViewsOf(scene, scale, text) : ViewsOf(scene, scale, text);
  const std::vector<Camera> cameras = CamerasOf(scene);
  const auto place = [&](int v) { return cameras[static_cast<size_t>(v)].Center(); };
  const double distance = (place(views[0]) - place(views[1])).norm();
  if (!(distance > 0)) throw InputError("--scale {}: both photos were taken from one place; name two others", text);
  return scale.meters / distance;
}

void ApplyFrame(const SceneFrame& frame, Scene* scene) {
  const Similarity transform = FromFound(frame);
  if (transform.IsIdentity()) return;
  for (SceneView& view : scene->views) {
    Eigen::Isometry3d& pose = view.cam_from_world.value();
    const Eigen::Vector3d position = -(pose.linear().transpose() * pose.translation());
    const Eigen::Vector3d moved = frame.scale * (frame.rotation * position - frame.center);
    pose.linear() = (pose.linear() * frame.rotation.transpose()).eval();
    pose.translation() = -(pose.linear() * moved);
  }
  for (ScenePoint& p : scene->points) p.xyz = frame.scale * (frame.rotation * p.xyz - frame.center);
}

}  // namespace oraclegs
