#include "oraclegs/render/surface.h"

#include <Eigen/Geometry>
#include <cmath>

#include "oraclegs/core/parallel.h"

namespace oraclegs {
namespace {

constexpr int64_t kSurfaceRows = 8;  // rows a task

/// Neighbors of a pixel along an axis, for the slope of inverse depth, which is constant on a plane. At an edge of
/// depth the slope is that of the flatter side.
struct InverseDepthAxis {
  const float* at;
  int before, after;  // pixels that there are on each side, at most the reach
  int64_t stride;

  /// Change of inverse depth per pixel; NAN when neither side has a surface.
  float Slope() const {
    const float here = *at, left = before > 0 ? at[-before * stride] : 0, right = after > 0 ? at[after * stride] : 0;
    const float from_left = (here - left) / static_cast<float>(before);
    const float to_right = (right - here) / static_cast<float>(after);
    if (left <= 0 && right <= 0) return NAN;
    if (left <= 0) return to_right;
    if (right <= 0) return from_left;
    const bool edge = std::abs(from_left - to_right) * static_cast<float>(before + after) > kSurfaceEdge * here;
    if (!edge) return (from_left + to_right) / 2;
    return std::abs(from_left) < std::abs(to_right) ? from_left : to_right;
  }

  static constexpr float kSurfaceEdge = 0.05f;  // relative bend of inverse depth over the reach
};

}  // namespace

RenderedSurface SurfaceOf(const RenderOutput& render, const Camera& camera, int reach) {
  const int width = camera.width, height = camera.height;
  const Buffer<float> alpha = render.alpha.To(kCpu), inverse = render.inv_depth.To(kCpu);
  const auto pixels = static_cast<size_t>(width) * static_cast<size_t>(height);
  if (alpha.count() != static_cast<int64_t>(pixels)) throw ShapeError("SurfaceOf: {}", alpha.shape().Text());
  RenderedSurface surface{camera, std::vector<float>(pixels), std::vector<Eigen::Vector3f>(pixels)};
  for (size_t i = 0; i < pixels; ++i) {
    const auto at = static_cast<int64_t>(i);
    surface.inv_depth[i] = alpha[at] >= kMinSurfaceAlpha ? inverse[at] / alpha[at] : 0;
  }
  ParallelBlocks(height, kSurfaceRows, [&](int64_t begin, int64_t end) {
    for (auto y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      for (int x = 0; x < width; ++x) {
        const size_t i = static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
        Eigen::Vector3f& normal = surface.normals[i];
        normal.setZero();
        const float here = surface.inv_depth[i];
        if (!(here > 0)) continue;
        const InverseDepthAxis across{&surface.inv_depth[i], std::min(reach, x), std::min(reach, width - 1 - x), 1};
        const InverseDepthAxis down{&surface.inv_depth[i], std::min(reach, y), std::min(reach, height - 1 - y), width};
        const float du = across.Slope(), dv = down.Slope();
        if (std::isnan(du) || std::isnan(dv)) continue;
        // On the plane n . X = d, 1/z is linear in the pixel: n.x = d fx du, n.y = d fy dv; d < 0 faces the camera.
        const auto fx = static_cast<float>(camera.fx), fy = static_cast<float>(camera.fy);
        const float u = (static_cast<float>(x) + 0.5f - static_cast<float>(camera.cx)) * du;
        const float v = (static_cast<float>(y) + 0.5f - static_cast<float>(camera.cy)) * dv;
        normal = -Eigen::Vector3f(fx * du, fy * dv, here - u - v).normalized();
      }
    }
  });
  return surface;
}

}  // namespace oraclegs
