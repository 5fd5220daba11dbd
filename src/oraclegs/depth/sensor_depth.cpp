#include "oraclegs/depth/sensor_depth.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>

#include "oraclegs/camera/distortion_models.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/scene/fit_cameras.h"

namespace oraclegs {
namespace {

constexpr uint16_t kSaturated = 65535;
constexpr int kHighLevel = 2;            // of confidences as ARKit has them: 0, 1, 2
constexpr float kLowConfidence = 0.25f;  // of the highest: below it, depth is not used
constexpr float kSureOfSensor = 0.9f;    // confidence of the highest level
constexpr int kTaps = 2;                 // of a plane's window, to each side
constexpr int kStepsPerWidth = 256;      // measurements that phones make in a row
constexpr float kSensorSurface = 0.05f;  // relative difference of depth at which a neighbor counts half, at first
constexpr float kOffPlane = 0.01f;       // and from the plane, then
constexpr int kPlaneFits = 3;
constexpr float kMinSupport = 0.6f;  // of the window's weights: less is an edge, or a speck
constexpr float kBesideEdge = 0.5f;  // times which confidence counts there

/// A sensor's measurements in the scene's units; 0 = unknown or not to be trusted.
struct SensorGrid {
  int width = 0, height = 0, step = 1;
  std::vector<float> inv_depth, confidence;

  size_t At(int x, int y) const { return static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x); }
};

void RequireAspect(const SceneView& view, const std::filesystem::path& file, int width, int height) {
  if (HaveSameAspect(width, height, view.intrinsics.width, view.intrinsics.height)) return;
  throw InputError("{}: is {} x {}, but its photo {} is {} x {}; --depth-prior stereo does without it", file.string(),
                   width, height, view.name, view.intrinsics.width, view.intrinsics.height);
}

/// [0, kSureOfSensor] for each pixel of the grid.
std::vector<float> ReadConfidence(const SceneView& view, const SensorGrid& grid) {
  std::vector<float> out(static_cast<size_t>(grid.width) * static_cast<size_t>(grid.height), kSureOfSensor);
  if (view.confidence_path.empty()) return out;
  const Image8 image = ReadImage(view.confidence_path);
  RequireAspect(view, view.confidence_path, image.width, image.height);
  const auto channels = static_cast<size_t>(image.channels);
  const size_t pixels = image.data.size() / channels;
  int highest = 0;
  for (size_t i = 0; i < pixels; ++i) highest = std::max<int>(highest, image.data[i * channels]);
  const auto full = static_cast<float>(highest <= kHighLevel ? kHighLevel : 255);
  for (int y = 0; y < grid.height; ++y) {
    for (int x = 0; x < grid.width; ++x) {
      const int64_t column = (2 * int64_t{x} + 1) * image.width / (2 * int64_t{grid.width});
      const int64_t row = (2 * int64_t{y} + 1) * image.height / (2 * int64_t{grid.height});
      const float level = static_cast<float>(image.data[static_cast<size_t>(row * image.width + column) * channels]);
      out[grid.At(x, y)] = level < kLowConfidence * full ? 0 : kSureOfSensor * (1 + level / full) / 2;
    }
  }
  return out;
}

SensorGrid ReadGrid(const SceneView& view, double unit) {
  const Image16 image = ReadPng16(view.depth_path);
  RequireAspect(view, view.depth_path, image.width, image.height);
  SensorGrid grid{image.width, image.height, std::max(1, (image.width + kStepsPerWidth / 2) / kStepsPerWidth), {}, {}};
  grid.confidence = ReadConfidence(view, grid);
  grid.inv_depth.resize(image.values.size());
  for (size_t i = 0; i < image.values.size(); ++i) {
    const uint16_t level = image.values[i];
    const double inv_depth = level == 0 || level == kSaturated ? 0 : unit / (level * view.depth_unit);
    const bool is_known = inv_depth > 0 && std::isfinite(inv_depth) && grid.confidence[i] > 0;
    grid.inv_depth[i] = is_known ? static_cast<float>(inv_depth) : 0;
  }
  return grid;
}

/// A plane over the grid, at (u, v), and the share of its window that lies on it.
struct FittedPlane {
  Plane plane;  ///< changes per pixel of the grid
  float support = 0;
};

/// Least squares with weights that fall with the distance from the plane before, which begins level at the pixel's own
/// measurement. Nothing where that is unknown, or off the plane.
std::optional<FittedPlane> FitPlane(const SensorGrid& grid, double u, double v) {
  const int x = std::min(static_cast<int>(u), grid.width - 1), y = std::min(static_cast<int>(v), grid.height - 1);
  const float own = grid.inv_depth[grid.At(x, y)];
  if (!(own > 0)) return std::nullopt;
  const auto own_x = static_cast<float>(x + 0.5 - u), own_y = static_cast<float>(y + 0.5 - v);
  Plane plane{own, 0, 0};
  float support = 0;
  for (int fit = 0; fit < kPlaneFits; ++fit) {
    const float width = (fit == 0 ? kSensorSurface : kOffPlane) * own;
    Eigen::Matrix3f normal = Eigen::Matrix3f::Zero();
    Eigen::Vector3f right = Eigen::Vector3f::Zero();
    int taps = 0;
    for (int row = y - kTaps * grid.step; row <= y + kTaps * grid.step; row += grid.step) {
      for (int column = x - kTaps * grid.step; column <= x + kTaps * grid.step; column += grid.step) {
        if (row < 0 || column < 0 || row >= grid.height || column >= grid.width) continue;
        ++taps;
        const float there = grid.inv_depth[grid.At(column, row)];
        if (!(there > 0)) continue;
        const Eigen::Vector3f at(1, static_cast<float>(column + 0.5 - u), static_cast<float>(row + 0.5 - v));
        const float off = (there - plane.At(at.y(), at.z())) / width;
        const float weight = 1 / (1 + off * off);
        normal += weight * at * at.transpose();
        right += weight * there * at;
      }
    }
    support = normal(0, 0) / static_cast<float>(std::max(1, taps));
    const auto solved = normal.fullPivLu();
    if (!solved.isInvertible()) return std::nullopt;
    const Eigen::Vector3f best = solved.solve(right);
    plane = {best.x(), best.y(), best.z()};
  }
  const bool holds = plane.inv_depth > 0 && std::abs(plane.At(own_x, own_y) - own) < 2 * kOffPlane * own;
  if (!holds) return std::nullopt;
  return FittedPlane{plane, support};
}

}  // namespace

DepthMap ReadSensorDepth(const SceneView& view, const Camera& camera, double unit) {
  const SensorGrid grid = ReadGrid(view, unit);
  const DistortionMap lens(view.intrinsics);
  const double across = static_cast<double>(grid.width) / view.intrinsics.width;
  const double down = static_cast<double>(grid.height) / view.intrinsics.height;
  // Pixels of the grid for one of the camera.
  const auto right = static_cast<float>(across * view.intrinsics.fx() / camera.fx);
  const auto below = static_cast<float>(down * view.intrinsics.fy() / camera.fy);
  const size_t pixels = static_cast<size_t>(camera.width) * static_cast<size_t>(camera.height);
  DepthMap map{view.name, camera, std::vector<float>(pixels, 0),
               std::vector<Eigen::Vector3f>(pixels, Eigen::Vector3f::Zero()), std::vector<float>(pixels, 0)};
  for (size_t i = 0; i < pixels; ++i) {
    const size_t width = static_cast<size_t>(camera.width);
    const double x = static_cast<double>(i % width) + 0.5, y = static_cast<double>(i / width) + 0.5;
    double u = 0, v = 0;
    if (!lens.Project((x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, &u, &v)) continue;
    u *= across, v *= down;
    if (!(u >= 0 && v >= 0 && u < grid.width && v < grid.height)) continue;
    const auto fitted = FitPlane(grid, u, v);
    if (!fitted) continue;
    const float own = grid.confidence[grid.At(static_cast<int>(u), static_cast<int>(v))];
    const Plane plane{fitted->plane.inv_depth, fitted->plane.dx * right, fitted->plane.dy * below};
    map.inv_depth[i] = plane.inv_depth;
    map.confidence[i] = own * (fitted->support < kMinSupport ? kBesideEdge : 1);
    map.normals[i] = NormalOf(camera, plane, static_cast<float>(x), static_cast<float>(y));
  }
  return map;
}

std::vector<DepthMap> ReadSensorMaps(const Scene& scene, const std::vector<int>& views,
                                     const std::vector<Camera>& cameras, double unit) {
  std::vector<DepthMap> maps(views.size());
  ParallelFor(static_cast<int64_t>(views.size()), [&](int64_t task) {
    ThrowIfInterrupted();
    const auto v = static_cast<size_t>(task);
    const SceneView& view = scene.views[static_cast<size_t>(views[v])];
    maps[v] =
        view.depth_path.empty() ? DepthMap{view.name, cameras[v], {}, {}, {}} : ReadSensorDepth(view, cameras[v], unit);
  });
  return maps;
}

}  // namespace oraclegs
