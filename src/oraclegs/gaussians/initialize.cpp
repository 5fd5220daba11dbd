#include "oraclegs/gaussians/initialize.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

#include "oraclegs/camera/scene_bounds.h"
#include "oraclegs/core/cuda/memory.h"
#include "oraclegs/core/cuda_library.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/rng.h"
#include "oraclegs/gaussians/cuda/neighbors.h"
#include "oraclegs/gaussians/neighbors.h"
#include "oraclegs/gaussians/ply_header.h"

namespace oraclegs {
namespace {

constexpr double kMinSquaredDistance = 1e-7;        // duplicates would have no size at all
constexpr double kBlenderHalfSide = 1.3;            // world units
constexpr double kCubeHalfSide = 3;                 // of the cameras' extent
constexpr double kTooClose = 0.2;                   // of the radius: nothing starts right in front of a camera
constexpr int64_t kProbes = 20000, kMinHits = 200;  // 1%: a sparser overlap would cost too many draws

/// Nearly gray; no two points have quite the same color.
Eigen::Vector3f NearGray(Rng* rng) {
  Eigen::Vector3f rgb;
  for (int c = 0; c < 3; ++c) rgb[c] = static_cast<float>(0.5 + kConstantSh * rng->Uniform() / 255);
  return rgb;
}

Eigen::Vector3d UniformInBall(Rng* rng) {
  const double z = rng->Uniform(-1, 1), angle = rng->Uniform(0, 2 * M_PI), r = std::cbrt(rng->Uniform());
  const double flat = std::sqrt(std::max(0.0, 1 - z * z));
  return r * Eigen::Vector3d(flat * std::cos(angle), flat * std::sin(angle), z);
}

bool Sees(const Camera& camera, const Eigen::Vector3d& point) {
  const Eigen::Vector3d p = camera.cam_from_world * point;
  if (!(p.z() > 0)) return false;
  const double x = camera.fx * p.x() / p.z() + camera.cx, y = camera.fy * p.y() / p.z() + camera.cy;
  return x >= 0 && x < camera.width && y >= 0 && y < camera.height;
}

class ViewVolume {
 public:
  explicit ViewVolume(const std::vector<Camera>& cameras) : cameras_(cameras), ball_(LookedAt(cameras)) {}

  /// Draws a candidate; true when at least `views` cameras see it and none is too close.
  bool Draw(Rng* rng, int views, Eigen::Vector3d* point) const {
    *point = ball_.center + ball_.radius * UniformInBall(rng);
    for (const Camera& c : cameras_) {
      if ((c.Center() - *point).norm() < kTooClose * ball_.radius) return false;
    }
    int seen = 0;
    for (const Camera& c : cameras_) {
      if (seen >= views) break;
      seen += Sees(c, *point) ? 1 : 0;
    }
    return seen >= views;
  }

  /// The largest number of views, up to two, that a fair share of the ball is seen by. Zero (cameras that see nothing
  /// of it) ends a draw that would never succeed.
  int AttainableViews(uint64_t seed) const {
    for (const int views : {2, 1}) {
      Rng rng(seed, RandomStream::kInitialPoints);
      Eigen::Vector3d ignored;
      int64_t hits = 0;
      for (int64_t i = 0; i < kProbes; ++i) hits += Draw(&rng, views, &ignored) ? 1 : 0;
      if (hits >= kMinHits) return views;
    }
    return 0;
  }

  Eigen::Vector3d Anywhere(Rng* rng) const { return ball_.center + ball_.radius * UniformInBall(rng); }

 private:
  const std::vector<Camera>& cameras_;
  Ball ball_;
};

PointCloud InCube(double half_side, int64_t n, uint64_t seed) {
  Rng rng(seed, RandomStream::kInitialPoints);
  PointCloud cloud;
  cloud.xyz.resize(n);
  cloud.rgb.resize(n);
  for (int64_t i = 0; i < n; ++i) {
    for (int axis = 0; axis < 3; ++axis) cloud.xyz[i][axis] = static_cast<float>(rng.Uniform(-half_side, half_side));
    cloud.rgb[i] = NearGray(&rng);
  }
  return cloud;
}

}  // namespace

PointCloud ToPointCloud(const std::vector<ScenePoint>& points) {
  PointCloud cloud;
  cloud.xyz.reserve(points.size());
  cloud.rgb.reserve(points.size());
  for (const ScenePoint& p : points) {
    cloud.xyz.push_back(p.xyz.cast<float>());
    cloud.rgb.push_back(Eigen::Vector3f(p.rgb[0], p.rgb[1], p.rgb[2]) / 255.f);
  }
  return cloud;
}

PointCloud RandomPointsInBlenderCube(int64_t n, uint64_t seed) { return InCube(kBlenderHalfSide, n, seed); }

PointCloud RandomPointsInCube(const std::vector<Camera>& cameras, int64_t n, uint64_t seed) {
  return InCube(kCubeHalfSide * SpatialExtent(cameras), n, seed);
}

PointCloud RandomPointsInView(const std::vector<Camera>& cameras, int64_t n, uint64_t seed) {
  if (cameras.empty()) throw std::invalid_argument("RandomPointsInView: no cameras");
  const ViewVolume volume(cameras);
  const int views = volume.AttainableViews(seed);
  Rng rng(seed, RandomStream::kInitialPoints);
  PointCloud cloud;
  cloud.xyz.reserve(n);
  cloud.rgb.reserve(n);
  while (static_cast<int64_t>(cloud.xyz.size()) < n) {
    Eigen::Vector3d point;
    if (views == 0) {
      point = volume.Anywhere(&rng);
    } else if (!volume.Draw(&rng, views, &point)) {
      continue;
    }
    cloud.xyz.push_back(point.cast<float>());
    cloud.rgb.push_back(NearGray(&rng));
  }
  return cloud;
}

namespace {

std::vector<double> MeansOn(Device device, const std::vector<Eigen::Vector3f>& points) {
  if (device.is_cpu()) return KdTree(points).MeanSquaredDistanceToThree();
  CudaFunction<decltype(cuda::UseDevice)>("UseDevice")(device.index);
  return CudaFunction<decltype(cuda::MeanSquaredDistanceToThree)>("MeanSquaredDistanceToThree")(points);
}

}  // namespace

PointCloud ReadPointPly(const std::filesystem::path& path) {
  constexpr float kGray = 0.5f;
  const std::string bytes = ReadFile(path), file = path.string();
  const PlyHeader header = ParsePlyHeader(bytes, file);
  const int vertex = header.Find("vertex");
  const auto type_of = [&](const char* name) {
    const int property = vertex < 0 ? -1 : header.elements[vertex].Find(name);
    return property < 0 ? std::optional<PlyType>() : header.elements[vertex].properties[property].type;
  };
  const bool has_colors = type_of("red") && type_of("green") && type_of("blue");
  std::vector<std::string> names = {"x", "y", "z"};
  if (has_colors) names.insert(names.end(), {"red", "green", "blue"});
  const float white = type_of("red") == PlyType::kUint8 ? 255.f : 1.f;
  const std::vector<float> values = ReadPlyColumns(bytes, header, "vertex", names, file);
  PointCloud cloud;
  for (size_t at = 0; at < values.size(); at += names.size()) {
    const Eigen::Vector3f point(values[at], values[at + 1], values[at + 2]);
    Eigen::Vector3f color = Eigen::Vector3f::Constant(kGray);
    if (has_colors) color = Eigen::Vector3f(values[at + 3], values[at + 4], values[at + 5]) / white;
    if (!point.allFinite() || !color.allFinite()) continue;
    cloud.xyz.push_back(point);
    cloud.rgb.push_back(color.cwiseMax(0).cwiseMin(1));
  }
  return cloud;
}

std::vector<float> MeanSquaredNeighborDistance(const std::vector<Eigen::Vector3f>& points, Device device) {
  for (const Eigen::Vector3f& p : points) {
    if (!p.allFinite()) throw std::invalid_argument("MeanSquaredNeighborDistance: a coordinate is not finite");
  }
  const std::vector<double> means = MeansOn(device, points);
  std::vector<float> out(means.size());
  std::transform(means.begin(), means.end(), out.begin(), [](double d2) {
    return static_cast<float>(
        std::clamp(d2, kMinSquaredDistance, static_cast<double>(std::numeric_limits<float>::max())));
  });
  return out;
}

Gaussians InitializeGaussians(const PointCloud& points, const InitializeOptions& options, Device device) {
  if (points.rgb.size() != points.xyz.size()) {
    throw ShapeError("InitializeGaussians: {} colors for {} points", points.rgb.size(), points.xyz.size());
  }
  const std::vector<float> d2 = MeanSquaredNeighborDistance(points.xyz, device);
  const auto n = static_cast<int64_t>(points.xyz.size());
  Gaussians g = Gaussians::Zeros(n);
  const auto logit = static_cast<float>(std::log(options.opacity / (1 - options.opacity)));
  const GaussianRows all = g.Rows();
  for (int64_t i = 0; i < n; ++i) {
    const auto log_scale = static_cast<float>(std::log(options.scale_factor * std::sqrt(static_cast<double>(d2[i]))));
    const GaussianRows row = all.From(i);
    row.quats[0] = 1;
    row.opacity_logits[0] = logit;
    for (int k = 0; k < 3; ++k) {
      row.means[k] = points.xyz[i][k];
      row.log_scales[k] = log_scale;
      row.sh[k] = static_cast<float>((static_cast<double>(points.rgb[i][k]) - 0.5) / kConstantSh);
    }
  }
  return g;
}

}  // namespace oraclegs
