#include "oraclegs/networks/seva/cameras.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "oraclegs/core/parallel.h"

namespace oraclegs::seva {
namespace {

constexpr double kQuantile = 0.97, kFarthest = 1e6, kOutlier = 10, kInTheMiddle = 1e-5;

/// Lower median of a non-empty list.
double LowerMedian(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Quantile, linearly interpolated between order statistics.
double Quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  const double at = share * static_cast<double>(values.size() - 1);
  const auto low = static_cast<size_t>(at);
  const size_t high = std::min(low + 1, values.size() - 1);
  return values[low] + (at - static_cast<double>(low)) * (values[high] - values[low]);
}

}  // namespace

double RotationDegrees(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  const double cosine = ((a * b.transpose()).trace() - 1) / 2;
  return std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / M_PI;
}

SceneMiddle FindSceneMiddle(const std::vector<Eigen::Vector3d>& centers) {
  if (centers.empty()) throw ShapeError("FindSceneMiddle: there are no cameras");
  SceneMiddle middle;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const auto& center : centers) values.push_back(center[axis]);
    middle.median[axis] = LowerMedian(std::move(values));
  }
  std::vector<double> distances;
  for (const auto& center : centers) distances.push_back((center - middle.median).norm());
  middle.quantile = Quantile(distances, kQuantile);
  const double limit = std::min(kOutlier * middle.quantile, kFarthest);
  int count = 0;
  for (size_t i = 0; i < centers.size(); ++i) {
    middle.valid.push_back(distances[i] <= limit);
    if (!middle.valid.back()) continue;
    middle.mean += centers[i];
    ++count;
  }
  // The median of each coordinate may be farther than kFarthest from all centers; it then stands for the mean.
  middle.mean = count > 0 ? Eigen::Vector3d(middle.mean / count) : middle.median;
  return middle;
}

std::vector<View> NormalizedViews(const std::vector<View>& chunk, const std::vector<View>& all) {
  if (chunk.empty()) throw ShapeError("NormalizedViews: there are no frames");
  std::vector<Eigen::Vector3d> centers;
  for (const View& view : all) centers.push_back(view.center());
  const Eigen::Vector3d middle = FindSceneMiddle(centers).mean;
  const double first = (chunk.front().center() - middle).norm();
  const double scale = first <= kInTheMiddle ? kCameraScale : kCameraScale / first;
  std::vector<View> views = chunk;
  for (View& view : views) view.world_from_camera.translation() = scale * (view.center() - middle);
  return views;
}

Tensor PlueckerMaps(const std::vector<View>& views, int64_t height, int64_t width) {
  if (views.empty() || height <= 0 || width <= 0) {
    throw ShapeError("PlueckerMaps: {} views of {} x {} pixels", views.size(), width, height);
  }
  const Tensor maps = torch::empty({static_cast<int64_t>(views.size()), 6, height, width}, torch::kFloat);
  float* values = maps.data_ptr<float>();
  const int64_t pixels = height * width;
  const Eigen::Isometry3d first_from_world = views.front().world_from_camera.inverse();
  ParallelFor(static_cast<int64_t>(views.size()), [&](int64_t t) {
    const View& view = views[static_cast<size_t>(t)];
    const Eigen::Isometry3d pose = first_from_world * view.world_from_camera;
    Eigen::Matrix3d pixel_intrinsics = view.intrinsics;
    pixel_intrinsics.row(0) *= static_cast<double>(width);
    pixel_intrinsics.row(1) *= static_cast<double>(height);
    const Eigen::Matrix3d direction_of_pixel = pose.linear() * pixel_intrinsics.inverse();
    const Eigen::Vector3d origin = pose.translation();
    float* map = values + t * 6 * pixels;
    for (int64_t i = 0; i < pixels; ++i) {
      const auto column = static_cast<double>(i % width), row = static_cast<double>(i / width);
      const Eigen::Vector3d direction = (direction_of_pixel * Eigen::Vector3d(column + 0.5, row + 0.5, 1)).normalized();
      const Eigen::Vector3d moment = origin.cross(direction);
      for (int c = 0; c < 3; ++c) {
        map[c * pixels + i] = static_cast<float>(direction[c]);
        map[(c + 3) * pixels + i] = static_cast<float>(moment[c]);
      }
    }
  });
  return maps;
}

}  // namespace oraclegs::seva
