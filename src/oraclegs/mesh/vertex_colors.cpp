#include "oraclegs/mesh/vertex_colors.h"

#include <algorithm>
#include <cmath>

#include "oraclegs/core/parallel.h"

namespace oraclegs {
namespace {

constexpr int64_t kVerticesATask = 4096;
constexpr uint8_t kUnseenGray = 128;

/// Bilinear sample between pixel centers.
Eigen::Vector3f ColorAt(const Buffer<float>& image, float u, float v) {
  const auto width = static_cast<int>(image.size(1)), height = static_cast<int>(image.size(0));
  const float x = std::clamp(u - 0.5f, 0.f, static_cast<float>(width - 1));
  const float y = std::clamp(v - 0.5f, 0.f, static_cast<float>(height - 1));
  const int x0 = std::min(static_cast<int>(x), width - 2), y0 = std::min(static_cast<int>(y), height - 2);
  const float s = x - static_cast<float>(x0), t = y - static_cast<float>(y0);
  const auto pixel = [&](int px, int py) {
    return Eigen::Map<const Eigen::Vector3f>(image.data() + 3 * (static_cast<int64_t>(py) * width + px));
  };
  return (1 - t) * ((1 - s) * pixel(x0, y0) + s * pixel(x0 + 1, y0)) +
         t * ((1 - s) * pixel(x0, y0 + 1) + s * pixel(x0 + 1, y0 + 1));
}

}  // namespace

VertexColors::VertexColors(const TriangleMesh& mesh, double tolerance)
    : mesh_(mesh),
      tolerance_(static_cast<float>(tolerance)),
      sums_(mesh.positions.size(), Eigen::Vector3f::Zero()),
      weights_(mesh.positions.size()),
      views_(mesh.positions.size()) {}

void VertexColors::Add(const SurfaceView& view) {
  const Camera& camera = view.surface.camera;
  if (camera.width < 2 || camera.height < 2) return;
  const Eigen::Matrix3f rotation = camera.cam_from_world.linear().cast<float>();
  ParallelBlocks(static_cast<int64_t>(sums_.size()), kVerticesATask, [&](int64_t begin, int64_t end) {
    for (auto i = static_cast<size_t>(begin); i < static_cast<size_t>(end); ++i) {
      const Eigen::Vector3f point = (camera.cam_from_world * mesh_.positions[i].cast<double>()).cast<float>();
      if (point.z() <= 0 || (rotation * mesh_.normals[i]).dot(point) >= 0) continue;
      const float u = static_cast<float>(camera.fx) * point.x() / point.z() + static_cast<float>(camera.cx);
      const float v = static_cast<float>(camera.fy) * point.y() / point.z() + static_cast<float>(camera.cy);
      if (!(u >= 0 && v >= 0 && u < static_cast<float>(camera.width) && v < static_cast<float>(camera.height)))
        continue;
      const auto pixel = static_cast<size_t>(static_cast<int>(v)) * static_cast<size_t>(camera.width) +
                         static_cast<size_t>(static_cast<int>(u));
      const float weight = view.weights[pixel];
      if (weight <= 0 || std::abs(1 / view.surface.inv_depth[pixel] - point.z()) > tolerance_) continue;
      sums_[i] += weight * ColorAt(view.image, u, v);
      weights_[i] += weight;
      ++views_[i];
    }
  });
}

std::vector<std::array<uint8_t, 3>> VertexColors::Colors() const {
  std::vector<std::array<uint8_t, 3>> colors(sums_.size(), {kUnseenGray, kUnseenGray, kUnseenGray});
  for (size_t i = 0; i < sums_.size(); ++i) {
    if (weights_[i] <= 0) continue;
    for (int c = 0; c < 3; ++c) {
      const float value = std::clamp(sums_[i][c] / weights_[i], 0.f, 1.f);
      colors[i][static_cast<size_t>(c)] = static_cast<uint8_t>(std::lround(255 * value));
    }
  }
  return colors;
}

}  // namespace oraclegs
