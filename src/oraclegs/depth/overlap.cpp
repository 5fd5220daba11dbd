#include "oraclegs/depth/overlap.h"

#include <cstdint>

#include "oraclegs/core/statistics.h"

namespace oraclegs {
namespace {

constexpr int kOverlapStep = 8;             // pixels
constexpr double kMinAngleCosine = .99996;  // half a degree: less gives no depth
constexpr double kMaxAngleCosine = .2588;   // 75 degrees, as for confidence

bool IsSeenFrom(const Camera& other, const Eigen::Vector3d& point, const Eigen::Vector3d& center) {
  const Eigen::Vector3d in_camera = other.cam_from_world * point;
  if (!(in_camera.z() > 0)) return false;
  const double u = other.fx * in_camera.x() / in_camera.z() + other.cx;
  const double v = other.fy * in_camera.y() / in_camera.z() + other.cy;
  if (!(u >= 0 && v >= 0 && u < other.width && v < other.height)) return false;
  const double cosine = (point - center).normalized().dot((point - other.Center()).normalized());
  return cosine < kMinAngleCosine && cosine > kMaxAngleCosine;
}

/// Median known inverse depth, which stands for unknown ones; 0 when all are unknown.
float MedianInvDepth(const DepthMap& map) {
  std::vector<float> known;
  for (const float inv_depth : map.inv_depth) {
    if (inv_depth > 0) known.push_back(inv_depth);
  }
  return UpperMedian(std::move(known));
}

}  // namespace

Overlap MeasureOverlap(const std::vector<DepthMap>& maps, const std::vector<LoadedView>& views,
                       const Silhouettes& silhouettes) {
  int64_t pixels = 0, seen = 0, confident = 0;
  for (size_t m = 0; m < maps.size(); ++m) {
    const DepthMap& map = maps[m];
    const Camera& camera = map.camera;
    const Eigen::Isometry3d world_from_cam = camera.cam_from_world.inverse();
    const float usual = MedianInvDepth(map);
    for (int y = kOverlapStep / 2; y < camera.height; y += kOverlapStep) {
      for (int x = kOverlapStep / 2; x < camera.width; x += kOverlapStep) {
        const size_t p = static_cast<size_t>(y) * static_cast<size_t>(camera.width) + static_cast<size_t>(x);
        if (p >= map.size()) continue;
        if (!views[m].mask.empty() && views[m].mask[p] == 0) continue;
        if (!silhouettes.empty() && silhouettes.Object(m)[p] == 0) continue;
        ++pixels;
        const float inv_depth = map.inv_depth[p] > 0 ? map.inv_depth[p] : usual;
        if (inv_depth <= 0) continue;
        const double depth = 1 / static_cast<double>(inv_depth);
        const Eigen::Vector3d ray((x + .5 - camera.cx) / camera.fx, (y + .5 - camera.cy) / camera.fy, 1);
        const Eigen::Vector3d point = world_from_cam * (depth * ray);
        bool is_seen = false;
        for (size_t other = 0; other < maps.size() && !is_seen; ++other)
          is_seen = other != m && IsSeenFrom(maps[other].camera, point, camera.Center());
        seen += is_seen;
        confident += is_seen && map.confidence[p] >= kConfident;
      }
    }
  }
  const auto share = [](int64_t part, int64_t of) {
    return of > 0 ? static_cast<double>(part) / static_cast<double>(of) : 0;
  };
  return {share(seen, pixels), share(confident, seen)};
}

}  // namespace oraclegs
