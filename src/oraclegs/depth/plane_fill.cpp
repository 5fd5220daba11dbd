#include "oraclegs/depth/fusion.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "oraclegs/core/parallel.h"
#include "oraclegs/depth/plane.h"
#include "oraclegs/depth/scene_planes.h"
#include "oraclegs/depth/silhouettes.h"

namespace oraclegs {
namespace {

constexpr int kFillStep = 2;               // pixels between filled points
constexpr int kCells = 90;                 // along the image's larger side
constexpr int kMaxWindow = 16;             // cells to each side
constexpr float kMinWindowShare = 0.01f;   // of a window's pixels, on one plane and of the same color
constexpr float kMinAgreement = 0.5f;      // of the known pixels of the same color, on the plane
constexpr float kColorDeviation = 0.08f;   // of pixels of one surface, RMS over the channels
constexpr float kOnPlane = 0.02f;          // relative distance of a pixel's depth from its plane
constexpr float kFacing = 0.3f;            // cosine; seen at a grazing angle, normals are the least exact
constexpr float kBeyondRange = 2;          // times as near or far as any confident depth
constexpr float kSeenThroughFill = 0.97f;  // of the confident depth of another view
constexpr float kOccluded = 1.03f;
constexpr int kColorRadius = 2;
constexpr float kSameSurfaceColor = 0.06f;  // RMS over the channels, of means over patches
constexpr int kNoPlane = -1;

class PlaneFill {
 public:
  PlaneFill(const std::vector<DepthMap>& maps, const std::vector<LoadedView>& views, std::vector<ScenePlane> planes,
            const FusionOptions& options)
      : maps_(maps), views_(views), planes_(std::move(planes)), options_(options), silhouettes_(views) {
    for (const DepthMap& map : maps) filled_.emplace_back(map.size(), 0);
  }

  std::vector<DensePoint> Run() {
    return PointsOfViews(maps_.size(), [&](size_t v, std::vector<DensePoint>* points) { AddPointsOf(v, points); });
  }

 private:
  /// The plane that each cell of an image continues.
  struct CellPlanes {
    int size = 1, across = 0;         ///< pixels; cells
    std::vector<int> plane;           ///< plane of each cell, kNoPlane = none
    float nearest = 0, farthest = 0;  ///< range of inverse depth in which planes are continued

    int At(int x, int y) const { return plane[static_cast<size_t>(y / size) * across + x / size]; }
  };

  bool MayFill(size_t v, size_t i) const {
    return (views_[v].mask.empty() || views_[v].mask[i] != 0) &&
           (silhouettes_.empty() || silhouettes_.Object(v)[i] != 0);
  }

  /// Inverse depth at which a pixel's ray meets the plane; not positive where it does not.
  float Meet(const Eigen::Vector4f& in_camera, const Camera& camera, size_t i) const {
    const auto width = static_cast<size_t>(camera.width);
    const Eigen::Vector3f ray =
        RayOf(camera, static_cast<float>(i % width) + 0.5f, static_cast<float>(i / width) + 0.5f);
    return -in_camera.head<3>().dot(ray) / in_camera.w();
  }

  static Eigen::Vector4f InCamera(const ScenePlane& plane, const Camera& camera) {
    const Eigen::Vector3f normal = camera.cam_from_world.linear().cast<float>() * plane.normal;
    return {normal.x(), normal.y(), normal.z(),
            plane.offset - normal.dot(camera.cam_from_world.translation().cast<float>())};
  }

  int PlaneOf(const DepthMap& map, size_t i, const std::vector<Eigen::Vector4f>& planes) const {
    int best = kNoPlane;
    float nearest = kOnPlane;
    for (size_t p = 0; p < planes.size(); ++p) {
      const float off = std::abs(Meet(planes[p], map.camera, i) / map.inv_depth[i] - 1);
      if (off < nearest && std::abs(map.normals[i].dot(planes[p].head<3>())) > kFacing) {
        nearest = off, best = static_cast<int>(p);
      }
    }
    return best;
  }

  /// A square of an image: the number of its known pixels on each plane, and the mean colors of its known and of its
  /// unknown pixels.
  struct Cell {
    std::vector<float> on_plane;
    float known = 0, unknown = 0;  ///< pixels
    Eigen::Vector3f known_color = Eigen::Vector3f::Zero(), unknown_color = Eigen::Vector3f::Zero();
  };

  static float SameColor(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
    return std::exp(-(a - b).squaredNorm() / (6 * kColorDeviation * kColorDeviation));
  }

  /// The plane of most known pixels of a cell's color around it, in the smallest window with enough of them; kNoPlane
  /// where most of these are on no plane or on several.
  static int PlaneAround(const std::vector<Cell>& grid, const CellPlanes& cells, int x, int y, size_t planes) {
    const int down = static_cast<int>(grid.size()) / cells.across;
    const Cell& cell = grid[static_cast<size_t>(y) * cells.across + x];
    std::vector<float> votes(planes);
    for (int r = 1; cell.unknown > 0 && r <= kMaxWindow; r *= 2) {
      const int x0 = std::max(0, x - r), x1 = std::min(cells.across, x + r + 1);
      const int y0 = std::max(0, y - r), y1 = std::min(down, y + r + 1);
      const int pixels = (x1 - x0) * (y1 - y0) * cells.size * cells.size;
      std::fill(votes.begin(), votes.end(), 0.f);
      float all = 0;
      for (int j = y0; j < y1; ++j) {
        for (int i = x0; i < x1; ++i) {
          const Cell& near = grid[static_cast<size_t>(j) * cells.across + i];
          if (near.known == 0) continue;
          const float same = SameColor(cell.unknown_color, near.known_color);
          all += same * near.known;
          for (size_t p = 0; p < planes; ++p) votes[p] += same * near.on_plane[p];
        }
      }
      const auto most = std::max_element(votes.begin(), votes.end());
      if (*most > std::max(kMinWindowShare * static_cast<float>(pixels), kMinAgreement * all)) {
        return static_cast<int>(most - votes.begin());
      }
    }
    return kNoPlane;
  }

  CellPlanes Continue(size_t v, const std::vector<Eigen::Vector4f>& planes) const {
    const DepthMap& map = maps_[v];
    const int width = map.camera.width, height = map.camera.height;
    CellPlanes cells;
    cells.size = std::max(2, std::max(width, height) / kCells);
    cells.across = (width + cells.size - 1) / cells.size;
    const int down = (height + cells.size - 1) / cells.size;
    std::vector<Cell> grid(static_cast<size_t>(cells.across) * down);
    for (Cell& cell : grid) cell.on_plane.resize(planes.size());
    for (size_t i = 0; i < map.size(); ++i) {
      const int x = static_cast<int>(i) % width, y = static_cast<int>(i) / width;
      Cell& cell = grid[static_cast<size_t>(y / cells.size) * cells.across + x / cells.size];
      const Eigen::Map<const Eigen::Vector3f> color(views_[v].rgb.row(y) + 3 * x);
      if (map.confidence[i] < kConfident) {
        cell.unknown_color += color, ++cell.unknown;
        continue;
      }
      const float w = map.inv_depth[i];
      cells.nearest = std::max(cells.nearest, kBeyondRange * w);
      cells.farthest = cells.farthest == 0 ? w / kBeyondRange : std::min(cells.farthest, w / kBeyondRange);
      cell.known_color += color, ++cell.known;
      const int plane = PlaneOf(map, i, planes);
      if (plane != kNoPlane) ++cell.on_plane[static_cast<size_t>(plane)];
    }
    for (Cell& cell : grid) {
      if (cell.known > 0) cell.known_color /= cell.known;
      if (cell.unknown > 0) cell.unknown_color /= cell.unknown;
    }
    cells.plane.resize(grid.size());
    ParallelFor(down, [&](int64_t row) {
      const int y = static_cast<int>(row);
      for (int x = 0; x < cells.across; ++x) {
        cells.plane[static_cast<size_t>(y) * cells.across + x] = PlaneAround(grid, cells, x, y, planes.size());
      }
    });
    return cells;
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

  /// Whether one of the views with the place in frame shows the same color there, none sees through it, and no earlier
  /// view has filled the pixel it falls on, at any depth. Without the last condition a second extrapolation, behind the
  /// first, would paint a lawn twice.
  bool IsConsistent(size_t v, const Eigen::Vector3f& xyz, const Eigen::Vector3f& color) const {
    bool seen = false, similar = false;
    for (size_t other = 0; other < maps_.size(); ++other) {
      const DepthMap& map = maps_[other];
      if (other == v || map.size() == 0) continue;
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
      if (map.confidence[i] >= kConfident) {
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
    if (map.size() == 0) return;
    const Camera& camera = map.camera;
    std::vector<Eigen::Vector4f> planes;
    for (const ScenePlane& plane : planes_) planes.push_back(InCamera(plane, camera));
    const CellPlanes cells = Continue(v, planes);
    const Eigen::Isometry3f world_from_cam = camera.cam_from_world.inverse().cast<float>();
    std::vector<std::vector<std::pair<size_t, DensePoint>>> rows(
        static_cast<size_t>((camera.height + kFillStep - 1) / kFillStep));
    ParallelFor(static_cast<int64_t>(rows.size()), [&](int64_t row) {
      const int y = static_cast<int>(row) * kFillStep;
      for (int x = 0; x < camera.width; x += kFillStep) {
        const size_t i = static_cast<size_t>(y) * camera.width + x;
        const int plane = cells.At(x, y);
        if (plane == kNoPlane || map.confidence[i] >= kConfident || !MayFill(v, i)) continue;
        const float w = Meet(planes[static_cast<size_t>(plane)], camera, i);
        if (!(w > cells.farthest && w < cells.nearest)) continue;
        const Eigen::Vector3f xyz =
            world_from_cam * (RayOf(camera, static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f) / w).eval();
        const Eigen::Vector3f color = PatchColor(v, x, y);
        if (!IsConsistent(v, xyz, color)) continue;
        Eigen::Vector3f normal = planes_[static_cast<size_t>(plane)].normal;
        if (normal.dot(xyz - camera.Center().cast<float>()) > 0) normal = -normal;
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
  std::vector<ScenePlane> planes_;
  const FusionOptions& options_;
  Silhouettes silhouettes_;
  std::vector<std::vector<uint8_t>> filled_;
};

}  // namespace

std::vector<DensePoint> FillPlanes(const std::vector<DepthMap>& maps, const std::vector<LoadedView>& views,
                                   const std::vector<DensePoint>& points, const FusionOptions& options) {
  std::vector<ScenePlane> planes;
  if (!maps.empty()) planes = FindPlanes(points);
  if (planes.empty()) return {};
  return PlaneFill(maps, views, std::move(planes), options).Run();
}

}  // namespace oraclegs
