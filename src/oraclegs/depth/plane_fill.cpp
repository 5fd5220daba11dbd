#include "oraclegs/depth/plane_fill.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "oraclegs/core/parallel.h"
#include "oraclegs/depth/continued_planes.h"
#include "oraclegs/depth/plane.h"
#include "oraclegs/depth/silhouettes.h"

namespace oraclegs {
namespace {

constexpr int kFillStep = 2;               // pixels between filled points
constexpr float kMinFacing = 0.05f;        // cosine; what is seen at a more grazing angle is not continued
constexpr float kSeenThroughFill = 0.97f;  // of the confident depth of another view
constexpr float kOccluded = 1.03f;
constexpr int kColorRadius = 2;
constexpr float kSameSurfaceColor = 0.06f;  // RMS over the channels, of means over patches

class PlaneFill {
 public:
  PlaneFill(const std::vector<DepthMap>& maps, const std::vector<LoadedView>& views, const FusionOptions& options)
      : maps_(maps), views_(views), options_(options), silhouettes_(views) {
    for (const DepthMap& map : maps) filled_.emplace_back(map.size(), 0);
  }

  std::vector<DensePoint> Run() {
    return PointsOfViews(maps_.size(), [&](size_t v, std::vector<DensePoint>* points) { AddPointsOf(v, points); });
  }

 private:
  bool MayFill(size_t v, size_t i) const {
    return (views_[v].mask.empty() || views_[v].mask[i] != 0) &&
           (silhouettes_.empty() || silhouettes_.Object(v)[i] != 0);
  }

  Eigen::Vector3f PatchColor(size_t v, int x, int y) const {
    const ImageF& rgb = views_[v].rgb;
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    int n = 0;
    for (int w = std::max(0, y - kColorRadius); w <= std::min(rgb.height - 1, y + kColorRadius); ++w) {
      for (int u = std::max(0, x - kColorRadius); u <= std::min(rgb.width - 1, x + kColorRadius); ++u, ++n) {
        sum += Eigen::Map<const Eigen::Vector3f>(rgb.row(w) + 3 * u);
      }
    }
    sum /= static_cast<float>(n);
    return options_.gains.empty() ? sum : sum.cwiseQuotient(options_.gains[v]).cwiseMin(1.f).eval();
  }

  /// True when of the views that have the place in frame one shows the same colour there, none sees through it, and no
  /// earlier one has filled the pixel it falls on, at any depth: otherwise a second extrapolation, behind the first,
  /// paints a lawn twice.
  bool IsConsistent(size_t v, const Eigen::Vector3f& xyz, const Eigen::Vector3f& color) const {
    bool seen = false, similar = false;
    for (size_t other = 0; other < maps_.size(); ++other) {
      if (other == v) continue;
      const DepthMap& map = maps_[other];
      const Eigen::Vector3f there = map.camera.cam_from_world.cast<float>() * xyz;
      if (there.z() <= 0) continue;
      const float u = static_cast<float>(map.camera.fx) * there.x() / there.z() + static_cast<float>(map.camera.cx);
      const float w = static_cast<float>(map.camera.fy) * there.y() / there.z() + static_cast<float>(map.camera.cy);
      if (!(u >= 0 && w >= 0 && u < static_cast<float>(map.camera.width) &&
            w < static_cast<float>(map.camera.height))) {
        continue;
      }
      const int x = static_cast<int>(u), y = static_cast<int>(w);
      const size_t i = static_cast<size_t>(y) * map.camera.width + x;
      if (!views_[other].mask.empty() && views_[other].mask[i] == 0) continue;
      if (!silhouettes_.empty() && !silhouettes_.MayContain(other, static_cast<float>(x), static_cast<float>(y)))
        return false;
      if (filled_[other][i] != 0 && other < v) return false;
      if (map.confidence[i] >= options_.min_confidence) {
        const float ratio = there.z() * map.inv_depth[i];
        if (ratio < kSeenThroughFill) return false;
        if (ratio > kOccluded) continue;
      }
      seen = true;
      similar = similar || (PatchColor(other, x, y) - color).norm() < kSameSurfaceColor * std::sqrt(3.f);
    }
    return similar || !seen;
  }

  void AddPointsOf(size_t v, std::vector<DensePoint>* points) {
    const DepthMap& map = maps_[v];
    const Camera& camera = map.camera;
    const ContinuedPlanes planes(map, views_[v].rgb, options_.min_confidence, [&](size_t i) { return MayFill(v, i); });
    const Eigen::Isometry3f world_from_cam = camera.cam_from_world.inverse().cast<float>();
    std::vector<std::vector<std::pair<size_t, DensePoint>>> rows(
        static_cast<size_t>((camera.height + kFillStep - 1) / kFillStep));
    ParallelFor(static_cast<int64_t>(rows.size()), [&](int64_t row) {
      const int y = static_cast<int>(row) * kFillStep;
      for (int x = 0; x < camera.width; x += kFillStep) {
        const size_t i = static_cast<size_t>(y) * camera.width + x;
        if (map.confidence[i] >= options_.min_confidence || !MayFill(v, i)) continue;
        const std::optional<Plane> plane = planes.At(x, y);
        if (!plane) continue;
        const float u = static_cast<float>(x) + 0.5f, t = static_cast<float>(y) + 0.5f, w = plane->inv_depth;
        const Eigen::Vector3f ray = RayOf(camera, u, t), facing = NormalOf(camera, *plane, u, t);
        if (std::abs(facing.dot(ray.normalized())) < kMinFacing) continue;
        const Eigen::Vector3f xyz = world_from_cam * (ray / w).eval();
        const Eigen::Vector3f color = PatchColor(v, x, y);
        if (!IsConsistent(v, xyz, color)) continue;
        const Eigen::Vector3f normal = world_from_cam.linear() * facing;
        rows[static_cast<size_t>(row)].push_back(
            {i, {xyz, normal, color, 0, kFillStep / (w * static_cast<float>(camera.fx)), 0, 1}});
      }
    });
    for (const auto& row : rows) {
      for (const auto& [i, point] : row) {
        points->push_back(point);
        const int x = static_cast<int>(i % static_cast<size_t>(camera.width)),
                  y = static_cast<int>(i / static_cast<size_t>(camera.width));
        for (int u = y; u < std::min(camera.height, y + kFillStep); ++u) {
          for (int t = x; t < std::min(camera.width, x + kFillStep); ++t)
            filled_[v][static_cast<size_t>(u) * camera.width + t] = 1;
        }
      }
    }
  }

  const std::vector<DepthMap>& maps_;
  const std::vector<LoadedView>& views_;
  const FusionOptions& options_;
  Silhouettes silhouettes_;
  std::vector<std::vector<uint8_t>> filled_;
};

}  // namespace

std::vector<DensePoint> FillPlanes(const std::vector<DepthMap>& maps, const std::vector<LoadedView>& views,
                                   const FusionOptions& options) {
  return PlaneFill(maps, views, options).Run();
}

}  // namespace oraclegs
