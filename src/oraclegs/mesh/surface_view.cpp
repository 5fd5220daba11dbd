#include "oraclegs/mesh/surface_view.h"

#include <algorithm>
#include <cmath>

#include "oraclegs/core/parallel.h"

namespace oraclegs {
namespace {

constexpr float kMinOpaque = 0.9f;       // of alpha
constexpr float kMinCosine = 0.1f;       // between normal and line of sight: 84 degrees
constexpr float kMaxBend = 0.02f;        // of inverse depth between neighbors, relative: an edge
constexpr float kMaxBendOfSlope = 0.6f;  // of the change to the neighbor that differs more
constexpr int kViewReach = 2;            // pixels, of normals
constexpr int64_t kViewRows = 8;         // rows a task

/// Whether inverse depth bends, relative to the line through both neighbors, by much and by as much as it changes. A
/// floor at a grazing angle changes more than it bends.
bool IsEdge(const float* at, int64_t stride) {
  const float before = at[-stride], here = *at, after = at[stride];
  if (before <= 0 || after <= 0) return true;
  const float bend = std::abs(before + after - 2 * here);
  return bend > kMaxBend * here && bend > kMaxBendOfSlope * std::max(std::abs(here - before), std::abs(after - here));
}

/// Mask of the inside of smooth surfaces: 1 for pixels on no edge of depth and not on the border of the image.
std::vector<uint8_t> SmoothPixels(const RenderedSurface& surface) {
  const int64_t width = surface.camera.width, height = surface.camera.height;
  std::vector<uint8_t> smooth(surface.inv_depth.size());
  for (int64_t y = 1; y + 1 < height; ++y) {
    for (int64_t x = 1; x + 1 < width; ++x) {
      const float* at = &surface.inv_depth[static_cast<size_t>(y * width + x)];
      smooth[static_cast<size_t>(y * width + x)] = *at > 0 && !IsEdge(at, 1) && !IsEdge(at, width) ? 1 : 0;
    }
  }
  return smooth;
}

}  // namespace

SurfaceView SurfaceViewOf(const RenderOutput& render, const Camera& camera) {
  SurfaceView view;
  view.surface = SurfaceOf(render, camera, kViewReach);
  view.image = render.image.CopyOn(kCpu);
  const Buffer<float> alpha = render.alpha.To(kCpu);
  const std::vector<float>& inverse = view.surface.inv_depth;
  const std::vector<uint8_t> smooth = SmoothPixels(view.surface);
  view.weights.assign(inverse.size(), 0.f);
  ParallelBlocks(std::max(0, camera.height - 2), kViewRows, [&](int64_t begin, int64_t end) {
    for (int64_t y = begin + 1; y < end + 1; ++y) {
      for (int64_t x = 1; x < camera.width - 1; ++x) {
        const auto i = static_cast<size_t>(y * camera.width + x);
        if (alpha[static_cast<int64_t>(i)] < kMinOpaque || view.surface.normals[i].isZero()) continue;
        const auto w = static_cast<size_t>(camera.width);
        if (!smooth[i] || !smooth[i - 1] || !smooth[i + 1] || !smooth[i - w] || !smooth[i + w]) continue;
        const Eigen::Vector3f ray(static_cast<float>((static_cast<double>(x) + 0.5 - camera.cx) / camera.fx),
                                  static_cast<float>((static_cast<double>(y) + 0.5 - camera.cy) / camera.fy), 1);
        const float cosine = -view.surface.normals[i].dot(ray.normalized());
        if (cosine >= kMinCosine) view.weights[i] = cosine * inverse[i] * inverse[i];
      }
    }
  });
  return view;
}

}  // namespace oraclegs
