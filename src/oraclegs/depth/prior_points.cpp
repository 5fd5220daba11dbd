#include "oraclegs/depth/fusion.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "oraclegs/core/parallel.h"
#include "oraclegs/depth/plane.h"

namespace oraclegs {
namespace {

constexpr int kPriorStep = 3;              // pixels between points
constexpr float kFarBehind = 0.7f;         // of a pixel's inverse depth: what lies beyond is another surface
constexpr float kSeenThroughPrior = 0.9f;  // of the confident depth of another view

class PriorFill {
 public:
  PriorFill(const std::vector<DepthMap>& maps, const std::vector<LoadedView>& views, const FusionOptions& options)
      : maps_(maps), views_(views), options_(options) {
    for (const DepthMap& map : maps) {
      const auto cells = static_cast<size_t>(Across(map.camera)) * static_cast<size_t>(Cells(map.camera.height));
      covered_.emplace_back(cells, 0);
      cam_from_world_.push_back(map.camera.cam_from_world.cast<float>());
    }
  }

  std::vector<DensePoint> Run(const std::vector<DensePoint>& points) {
    Cover(points, 0);
    return PointsOfViews(maps_.size(), [&](size_t v, std::vector<DensePoint>* out) {
      if (!maps_[v].monocular) return;
      const std::vector<DensePoint> more = PointsOf(v);
      Cover(more, v + 1);
      out->insert(out->end(), more.begin(), more.end());
    });
  }

 private:
  static int Cells(int side) { return (side + kPriorStep - 1) / kPriorStep; }
  static int Across(const Camera& camera) { return Cells(camera.width); }

  /// A point's pixel in a view, and its depth there.
  struct Place {
    size_t pixel = 0, cell = 0;
    float depth = 0;
  };
  bool Project(size_t v, const Eigen::Vector3f& xyz, Place* place) const {
    const Camera& camera = maps_[v].camera;
    const Eigen::Vector3f p = cam_from_world_[v] * xyz;
    if (!(p.z() > 0) || maps_[v].size() == 0) return false;
    const float x = static_cast<float>(camera.fx) * p.x() / p.z() + static_cast<float>(camera.cx);
    const float y = static_cast<float>(camera.fy) * p.y() / p.z() + static_cast<float>(camera.cy);
    if (!(x >= 0 && y >= 0 && x < static_cast<float>(camera.width) && y < static_cast<float>(camera.height))) {
      return false;
    }
    const auto column = static_cast<size_t>(x), row = static_cast<size_t>(y);
    *place = {row * static_cast<size_t>(camera.width) + column,
              row / kPriorStep * static_cast<size_t>(Across(camera)) + column / kPriorStep, p.z()};
    return true;
  }

  /// Marks these points in the views from `first` on.
  void Cover(const std::vector<DensePoint>& points, size_t first) {
    if (first >= maps_.size()) return;
    ParallelFor(static_cast<int64_t>(maps_.size() - first), [&](int64_t i) {
      const size_t v = first + static_cast<size_t>(i);
      Place place;
      for (const DensePoint& point : points) {
        if (!Project(v, point.xyz, &place)) continue;
        if (1 / place.depth >= kFarBehind * maps_[v].inv_depth[place.pixel]) covered_[v][place.cell] = 1;
      }
    });
  }

  bool IsSeenThrough(size_t v, const Eigen::Vector3f& xyz) const {
    Place place;
    for (size_t other = 0; other < maps_.size(); ++other) {
      if (other == v || !Project(other, xyz, &place)) continue;
      const DepthMap& map = maps_[other];
      if (map.confidence[place.pixel] >= kConfident && place.depth * map.inv_depth[place.pixel] < kSeenThroughPrior) {
        return true;
      }
    }
    return false;
  }

  std::vector<DensePoint> PointsOf(size_t v) const {
    const DepthMap& map = maps_[v];
    const Camera& camera = map.camera;
    const Eigen::Isometry3f world_from_cam = camera.cam_from_world.inverse().cast<float>();
    std::vector<std::vector<DensePoint>> rows(static_cast<size_t>(Cells(camera.height)));
    ParallelFor(static_cast<int64_t>(rows.size()), [&](int64_t row) {
      const int y = std::min(static_cast<int>(row) * kPriorStep + kPriorStep / 2, camera.height - 1);
      for (int column = 0; column < Across(camera); ++column) {
        const int x = std::min(column * kPriorStep + kPriorStep / 2, camera.width - 1);
        const size_t i = static_cast<size_t>(y) * static_cast<size_t>(camera.width) + static_cast<size_t>(x);
        const size_t cell =
            static_cast<size_t>(row) * static_cast<size_t>(Across(camera)) + static_cast<size_t>(column);
        const float w = map.inv_depth[i];
        const bool unsure = map.confidence[i] > 0 && map.confidence[i] < kConfident && w > 0;
        if (!unsure || covered_[v][cell] != 0) continue;
        const Eigen::Vector3f ray = RayOf(camera, static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
        const Eigen::Vector3f xyz = world_from_cam * (ray / w).eval();
        if (IsSeenThrough(v, xyz)) continue;
        rows[static_cast<size_t>(row)].push_back({xyz, world_from_cam.linear() * map.normals[i], ColorOf(v, x, y),
                                                  map.confidence[i], kPriorStep / (w * static_cast<float>(camera.fx)),
                                                  0, 1});
      }
    });
    std::vector<DensePoint> points;
    for (const auto& row : rows) points.insert(points.end(), row.begin(), row.end());
    return points;
  }

  Eigen::Vector3f ColorOf(size_t v, int x, int y) const {
    const Eigen::Vector3f rgb = Eigen::Map<const Eigen::Vector3f>(views_[v].rgb.row(y) + 3 * x);
    return options_.gains.empty() ? rgb : rgb.cwiseQuotient(options_.gains[v]).cwiseMin(1.f).eval();
  }

  const std::vector<DepthMap>& maps_;
  const std::vector<LoadedView>& views_;
  const FusionOptions& options_;
  std::vector<std::vector<uint8_t>> covered_;  // of each view, in cells of kPriorStep pixels
  std::vector<Eigen::Isometry3f> cam_from_world_;
};

}  // namespace

std::vector<DensePoint> PriorPoints(const std::vector<DepthMap>& maps, const std::vector<LoadedView>& views,
                                    const std::vector<DensePoint>& points, const FusionOptions& options) {
  const bool any = std::any_of(maps.begin(), maps.end(), [](const DepthMap& map) { return map.monocular; });
  if (!any) return {};
  return PriorFill(maps, views, options).Run(points);
}

}  // namespace oraclegs
