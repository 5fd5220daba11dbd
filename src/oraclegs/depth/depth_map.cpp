#include "oraclegs/depth/depth_map.h"

#include <algorithm>
#include <cmath>

namespace oraclegs {

double ConfidentShare(const DepthMap& map) {
  if (map.confidence.empty()) return 0;
  const auto n = std::count_if(map.confidence.begin(), map.confidence.end(), [](float c) { return c >= kConfident; });
  return static_cast<double>(n) / static_cast<double>(map.confidence.size());
}

std::optional<size_t> FindPixel(const DepthMap& other, const PixelMap& there, const PixelMap& back,
                                const Eigen::Vector3f& uvw, const SamePoint& same) {
  const Eigen::Vector3f q = there(uvw.x(), uvw.y(), uvw.z());
  if (!(q.z() > 0) || other.size() == 0) return std::nullopt;
  const float u = q.x() / q.z(), v = q.y() / q.z();
  const auto width = static_cast<float>(other.camera.width), height = static_cast<float>(other.camera.height);
  if (!(u >= 0 && v >= 0 && u < width && v < height)) return std::nullopt;
  const size_t index = static_cast<size_t>(v) * static_cast<size_t>(other.camera.width) + static_cast<size_t>(u);
  if (other.confidence[index] < same.min_confidence) return std::nullopt;
  if (std::abs(q.z() / uvw.z() * other.inv_depth[index] - 1) > same.relative_depth) return std::nullopt;
  const Eigen::Vector3f r = back(u, v, other.inv_depth[index]);
  if (!(r.z() > 0)) return std::nullopt;
  if (std::hypot(r.x() / r.z() - uvw.x(), r.y() / r.z() - uvw.y()) > same.pixels) return std::nullopt;
  return index;
}

Eigen::Vector3f PixelOf(const DepthMap& map, size_t index) {
  const auto width = static_cast<size_t>(map.camera.width);
  return {static_cast<float>(index % width) + 0.5f, static_cast<float>(index / width) + 0.5f, map.inv_depth[index]};
}

std::optional<Eigen::Vector2f> RelativeSlope(const DepthMap& map, size_t index) {
  const Eigen::Vector3f uvw = PixelOf(map, index);
  const Eigen::Vector3f& normal = map.normals[index];
  // 1/z is n'(ray) / n'X along the plane's rays, linear over the image.
  const float facing = normal.dot(RayOf(map.camera, uvw.x(), uvw.y()));
  if (!(facing < 0)) return std::nullopt;
  return Eigen::Vector2f(normal.x() / (facing * static_cast<float>(map.camera.fx)),
                         normal.y() / (facing * static_cast<float>(map.camera.fy)));
}

}  // namespace oraclegs
