#include "oraclegs/networks/vggt/point_cloud.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "oraclegs/core/parallel.h"

namespace oraclegs::vggt {
namespace {

constexpr double kSameSurface = 0.05;  // relative difference of depth

/// Part of the network's input that shows an image, without padding; cropped rows are missing.
struct Window {
  double scale_x = 1, scale_y = 1;  // input pixels per pixel of the image
  int64_t left = 0, top = 0;        // first pixel of the image, negative when it was cropped
  int64_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  Window(const InputPlace& place, const Image8& image, const Tensor& images)
      : scale_x(static_cast<double>(place.width) / image.width),
        scale_y(static_cast<double>(place.height) / image.height),
        left(place.left),
        top(place.top),
        x0(std::max<int64_t>(place.left, 0)),
        y0(std::max<int64_t>(place.top, 0)),
        x1(std::min(place.left + place.width, images.size(3))),
        y1(std::min(place.top + place.height, images.size(2))) {}

  /// Center of an input pixel, in the image. The official code takes a pixel's corner for its center; half a pixel of
  /// 518 is below the network's error, and the rest of the program uses centers.
  Eigen::Vector2d ToImage(int64_t x, int64_t y) const {
    return {(static_cast<double>(x - left) + 0.5) / scale_x, (static_cast<double>(y - top) + 0.5) / scale_y};
  }
};

std::vector<Window> WindowsOf(const CloudSources& sources) {
  std::vector<Window> windows;
  for (size_t v = 0; v < sources.images.size(); ++v) {
    windows.emplace_back(sources.input.places[v], sources.images[v], sources.input.images);
  }
  return windows;
}

/// Depth and confidence as plain arrays.
struct Maps {
  const float* depth;
  const float* confidence;
  int64_t height, width;

  size_t At(size_t view, int64_t x, int64_t y) const {
    return (view * static_cast<size_t>(height) + static_cast<size_t>(y)) * static_cast<size_t>(width) +
           static_cast<size_t>(x);
  }
};

/// Pixel at which image `view` shows the point; nullopt unless its depth map has that surface there.
std::optional<CloudSight> Sight(const Eigen::Vector3d& xyz, size_t view, const CloudSources& sources,
                                const Window& window, const Maps& maps) {
  const Camera& camera = sources.cameras[view];
  const Eigen::Vector3d local = camera.cam_from_world * xyz;
  if (!(local.z() > 0)) return std::nullopt;
  const Eigen::Vector2d pixel(camera.fx * local.x() / local.z() + camera.cx,
                              camera.fy * local.y() / local.z() + camera.cy);
  const double u = std::floor(pixel.x() * window.scale_x) + static_cast<double>(window.left);
  const double v = std::floor(pixel.y() * window.scale_y) + static_cast<double>(window.top);
  const bool inside = u >= static_cast<double>(window.x0) && u < static_cast<double>(window.x1) &&
                      v >= static_cast<double>(window.y0) && v < static_cast<double>(window.y1);
  if (!inside) return std::nullopt;
  const auto depth = static_cast<double>(maps.depth[maps.At(view, static_cast<int64_t>(u), static_cast<int64_t>(v))]);
  if (!(std::abs(local.z() / depth - 1) < kSameSurface)) return std::nullopt;
  return CloudSight{static_cast<int>(view), pixel};
}

std::array<uint8_t, 3> ColorAt(const Image8& image, const Eigen::Vector2d& pixel) {
  const int x = std::clamp(static_cast<int>(pixel.x()), 0, image.width - 1);
  const int y = std::clamp(static_cast<int>(pixel.y()), 0, image.height - 1);
  const uint8_t* at = &image.data[(static_cast<size_t>(y) * image.width + x) * image.channels];
  return {at[0], at[1], at[2]};
}

}  // namespace

std::vector<Camera> ImageCameras(const Tensor& encoding, const Input& input, const std::vector<Image8>& images,
                                 const std::vector<std::string>& names) {
  const int64_t height = input.images.size(2), width = input.images.size(3);
  const DecodedCameras decoded = DecodeCameras(encoding, height, width);
  std::vector<std::string> bad;
  for (const int64_t v : decoded.without_focal) bad.push_back(names[static_cast<size_t>(v)]);
  std::vector<Camera> cameras;
  const auto extrinsics = decoded.extrinsics.accessor<float, 3>(), intrinsics = decoded.intrinsics.accessor<float, 3>();
  for (size_t p = 0; p < images.size(); ++p) {
    const auto v = static_cast<int64_t>(p);
    const InputPlace& place = input.places[p];
    const double scale_x = static_cast<double>(place.width) / images[p].width;
    const double scale_y = static_cast<double>(place.height) / images[p].height;
    Camera camera;
    camera.width = images[p].width, camera.height = images[p].height;
    camera.fx = static_cast<double>(intrinsics[v][0][0]) / scale_x;
    camera.fy = static_cast<double>(intrinsics[v][1][1]) / scale_y;
    camera.cx = (static_cast<double>(intrinsics[v][0][2]) - static_cast<double>(place.left)) / scale_x;
    camera.cy = (static_cast<double>(intrinsics[v][1][2]) - static_cast<double>(place.top)) / scale_y;
    Eigen::Matrix3d rotation;
    Eigen::Vector3d translation;
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) rotation(r, c) = static_cast<double>(extrinsics[v][r][c]);
      translation[r] = static_cast<double>(extrinsics[v][r][3]);
    }
    const bool finite = rotation.allFinite() && translation.allFinite() && std::isfinite(camera.fx) &&
                        std::isfinite(camera.fy) && camera.fx > 0 && camera.fy > 0;
    if (!finite && std::find(bad.begin(), bad.end(), names[p]) == bad.end()) bad.push_back(names[p]);
    if (finite) camera.cam_from_world.linear() = Eigen::Quaterniond(rotation).normalized().toRotationMatrix();
    camera.cam_from_world.translation() = translation;
    cameras.push_back(camera);
  }
  if (!bad.empty()) {
    throw InputError(
        "{}: VGGT finds no camera (no field of view, or numbers that are not finite); leave the photo out, or use "
        "--poses colmap",
        fmt::join(bad, ", "));
  }
  return cameras;
}

std::vector<CloudPoint> MakeCloud(const CloudSources& sources, size_t max_points) {
  const size_t views = sources.images.size();
  const int64_t height = sources.input.images.size(2), width = sources.input.images.size(3);
  RequireFloat("MakeCloud", "depth", sources.depth.depth, {static_cast<int64_t>(views), height, width});
  RequireFloat("MakeCloud", "confidence", sources.depth.confidence, {static_cast<int64_t>(views), height, width});
  const Maps maps{sources.depth.depth.data_ptr<float>(), sources.depth.confidence.data_ptr<float>(), height, width};
  const std::vector<Window> windows = WindowsOf(sources);
  double pixels = 0;
  for (const Window& w : windows) pixels += static_cast<double>((w.x1 - w.x0) * (w.y1 - w.y0));
  const auto step =
      static_cast<int64_t>(std::ceil(std::sqrt(pixels / static_cast<double>(std::max<size_t>(max_points, 1)))));
  struct Candidate {
    size_t view;
    int64_t x, y;
  };
  std::vector<Candidate> candidates;
  std::vector<float> confidence;
  for (size_t v = 0; v < views; ++v) {
    for (int64_t y = windows[v].y0 + step / 2; y < windows[v].y1; y += step) {
      for (int64_t x = windows[v].x0 + step / 2; x < windows[v].x1; x += step) {
        candidates.push_back({v, x, y});
        confidence.push_back(maps.confidence[maps.At(v, x, y)]);
      }
    }
  }
  std::vector<CloudPoint> cloud;
  if (candidates.empty()) return cloud;
  const auto middle = confidence.begin() + static_cast<int64_t>(confidence.size() / 2);
  std::nth_element(confidence.begin(), middle, confidence.end());
  const float median = *middle;
  std::vector<CloudPoint> found(candidates.size());
  ParallelFor(static_cast<int64_t>(candidates.size()), [&](int64_t i) {
    const auto [v, x, y] = candidates[static_cast<size_t>(i)];
    const size_t at = maps.At(v, x, y);
    if (!(maps.confidence[at] >= median) || !std::isfinite(maps.depth[at])) return;
    const Camera& camera = sources.cameras[v];
    const Eigen::Vector2d pixel = windows[v].ToImage(x, y);
    const auto z = static_cast<double>(maps.depth[at]);
    const Eigen::Vector3d local((pixel.x() - camera.cx) / camera.fx * z, (pixel.y() - camera.cy) / camera.fy * z, z);
    CloudPoint point{camera.cam_from_world.inverse() * local, ColorAt(sources.images[v], pixel), {}};
    for (size_t w = 0; w < views; ++w) {
      if (w == v) point.sights.push_back({static_cast<int>(v), pixel});
      const auto sight = w == v ? std::nullopt : Sight(point.xyz, w, sources, windows[w], maps);
      if (sight) point.sights.push_back(*sight);
    }
    if (point.sights.size() >= 2) found[static_cast<size_t>(i)] = std::move(point);
  });
  for (CloudPoint& point : found) {
    if (!point.sights.empty()) cloud.push_back(std::move(point));
  }
  return cloud;
}

}  // namespace oraclegs::vggt
