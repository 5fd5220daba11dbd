#include "oraclegs/depth/pose_offsets.h"

#include <algorithm>
#include <cmath>
#include <compare>
#include <map>
#include <optional>

#include "oraclegs/core/parallel.h"
#include "oraclegs/core/statistics.h"
#include "oraclegs/depth/reprojection.h"
#include "oraclegs/depth/stereo_setup.h"

namespace oraclegs {
namespace {

constexpr size_t kOffsetSources = 5;   // of each view
constexpr size_t kSharedPoints = 400;  // of each view, that choose the sources
constexpr int kChoiceStep = 2;         // pixels between candidates
constexpr float kOcclusion = 0.1f;     // relative depth between a point and what the source view shows
constexpr int64_t kPixelsPerTask = 128;
constexpr int kCellsPerSide = 3;        // of an image, for its residual
constexpr size_t kMinCellOffsets = 20;  // fewer say nothing of their cell
constexpr size_t kMinViewCells = 4;     // fewer say nothing of their view

/// Where the source view shows the pixel; nullopt where it is beyond the image, or the source's own depth says that
/// something else is there.
std::optional<Reprojection> Shown(const OffsetPixel& pixel, const Camera& view, const Camera& source,
                                  const DepthMap& map) {
  auto seen = Reproject(view, source, {pixel.u, pixel.v, pixel.inv_depth});
  if (!seen || !(seen->at.x() >= 0 && seen->at.y() >= 0 && seen->at.x() < source.width && seen->at.y() < source.height))
    return std::nullopt;
  if (map.size() == 0) return seen;
  const size_t index =
      static_cast<size_t>(seen->at.y()) * static_cast<size_t>(source.width) + static_cast<size_t>(seen->at.x());
  const double relative = seen->depth_ratio / pixel.inv_depth * map.inv_depth[index] - 1;
  if (map.confidence[index] >= kConfident && std::abs(relative) > kOcclusion) return std::nullopt;
  return seen;
}

/// Points of the confident depths, with the views that show them.
std::vector<ScenePoint> SharedPoints(const std::vector<DepthMap>& maps) {
  std::vector<ScenePoint> points;
  for (size_t v = 0; v < maps.size(); ++v) {
    const DepthMap& map = maps[v];
    std::vector<size_t> confident;
    for (size_t i = 0; i < map.size(); ++i) {
      if (map.confidence[i] >= kConfident) confident.push_back(i);
    }
    const size_t count = std::min(kSharedPoints, confident.size());
    for (size_t k = 0; k < count; ++k) {
      const Eigen::Vector3f uvw = PixelOf(map, confident[k * confident.size() / count]);
      const OffsetPixel pixel{static_cast<int>(v), uvw.x(), uvw.y(), static_cast<double>(uvw.z()), 0, 0};
      const Eigen::Vector3d in_camera = (RayOf(map.camera, uvw.x(), uvw.y()) / uvw.z()).cast<double>();
      ScenePoint point{map.camera.cam_from_world.inverse() * in_camera, {}, {}};
      for (size_t other = 0; other < maps.size(); ++other) {
        const bool shown = other == v || Shown(pixel, map.camera, maps[other].camera, maps[other]);
        if (shown) point.views.push_back(static_cast<int>(other));
      }
      if (point.views.size() > 1) points.push_back(std::move(point));
    }
  }
  return points;
}

}  // namespace

AcrossResidual ResidualAcross(const std::vector<OffsetPixel>& pixels, const std::vector<PatchOffset>& offsets,
                              const std::vector<Camera>& cameras) {
  struct Place {
    int view, source, cell;
    auto operator<=>(const Place&) const = default;
  };
  std::map<Place, std::vector<double>> cells;
  for (const PatchOffset& offset : offsets) {
    const OffsetPixel& pixel = pixels[static_cast<size_t>(offset.pixel)];
    const Camera& camera = cameras[static_cast<size_t>(pixel.view)];
    const int column = static_cast<int>(kCellsPerSide * pixel.u / static_cast<float>(camera.width));
    const int row = static_cast<int>(kCellsPerSide * pixel.v / static_cast<float>(camera.height));
    cells[{pixel.view, offset.source, kCellsPerSide * row + column}].push_back(offset.across);
  }
  std::vector<double> all;
  std::vector<std::vector<double>> by_view(cameras.size());
  for (auto& [place, values] : cells) {
    if (values.size() < kMinCellOffsets) continue;
    all.push_back(std::abs(Median(&values)));
    by_view[static_cast<size_t>(place.view)].push_back(all.back());
    by_view[static_cast<size_t>(place.source)].push_back(all.back());
  }
  AcrossResidual residual{Median(&all), {}, all.size()};
  for (std::vector<double>& values : by_view) {
    residual.views.push_back(values.size() < kMinViewCells ? 0 : Median(&values));
  }
  return residual;
}

OffsetMeter::OffsetMeter(const std::vector<LoadedView>& views, const std::vector<DepthMap>& maps)
    : views_(views),
      maps_(maps),
      sources_(FindNeighbors(views, SharedPoints(maps), kOffsetSources, [&](size_t v) { return maps[v].size() > 0; })) {
  for (const LoadedView& view : views) pyramids_.push_back(SearchPyramid(view.rgb));
}

std::vector<OffsetPixel> OffsetMeter::Choose(size_t most) const {
  std::vector<std::vector<OffsetPixel>> chosen(views_.size());
  ParallelFor(static_cast<int64_t>(views_.size()), [&](int64_t task) {
    const auto v = static_cast<size_t>(task);
    const DepthMap& map = maps_[v];
    if (sources_[v].empty()) return;
    std::vector<OffsetPixel> candidates;
    for (int y = kSearchRadius; y < map.camera.height - kSearchRadius; y += kChoiceStep) {
      for (int x = kSearchRadius; x < map.camera.width - kSearchRadius; x += kChoiceStep) {
        const size_t i = static_cast<size_t>(y) * map.camera.width + x;
        if (map.confidence[i] < kConfident) continue;
        const Eigen::Vector3f uvw = PixelOf(map, i);
        const std::optional<Eigen::Vector2f> slope = RelativeSlope(map, i);
        if (!slope) continue;
        const OffsetPixel pixel{static_cast<int>(v),          uvw.x(),    uvw.y(),
                                static_cast<double>(uvw.z()), slope->x(), slope->y()};
        const SearchPatch patch = SearchPatchAt(pyramids_[v].front(), map, pixel, {1, 1});
        if (patch.IsSurface() && patch.HasTexture()) candidates.push_back(pixel);
      }
    }
    const size_t count = std::min(most, candidates.size());
    for (size_t k = 0; k < count; ++k) chosen[v].push_back(candidates[k * candidates.size() / count]);
  });
  std::vector<OffsetPixel> pixels;
  for (const std::vector<OffsetPixel>& of_view : chosen) pixels.insert(pixels.end(), of_view.begin(), of_view.end());
  return pixels;
}

std::vector<PatchOffset> OffsetMeter::Measure(const std::vector<Camera>& cameras,
                                              const std::vector<OffsetPixel>& pixels) const {
  /// One resolution of a pair of views.
  struct PairLevel {
    PixelMap map;
    Eigen::Vector2f view_scale, source_scale;  // a pixel of the level in pixels of the full size
  };
  const auto scale_of = [&](size_t v, size_t level) {
    const ImageF& image = pyramids_[v][level];
    return Eigen::Vector2f(static_cast<float>(cameras[v].width) / static_cast<float>(image.width),
                           static_cast<float>(cameras[v].height) / static_cast<float>(image.height));
  };
  const auto camera_at = [&](size_t v, size_t level) {
    return Resized(cameras[v], pyramids_[v][level].width, pyramids_[v][level].height);
  };
  std::vector<std::vector<std::vector<PairLevel>>> pairs(cameras.size());
  for (size_t v = 0; v < cameras.size(); ++v) {
    for (const int s : sources_[v]) {
      const auto source = static_cast<size_t>(s);
      std::vector<PairLevel>& levels = pairs[v].emplace_back();
      for (size_t k = 0; k < std::min(pyramids_[v].size(), pyramids_[source].size()); ++k) {
        levels.push_back({MapBetween(camera_at(v, k), camera_at(source, k)), scale_of(v, k), scale_of(source, k)});
      }
    }
  }

  std::vector<std::optional<PatchOffset>> slots(pixels.size() * kOffsetSources);
  ParallelBlocks(static_cast<int64_t>(pixels.size()), kPixelsPerTask, [&](int64_t begin, int64_t end) {
    for (auto p = static_cast<size_t>(begin); p < static_cast<size_t>(end); ++p) {
      const OffsetPixel& pixel = pixels[p];
      const auto v = static_cast<size_t>(pixel.view);
      std::vector<SearchPatch> patches;
      for (size_t k = 0; k < pyramids_[v].size(); ++k) {
        patches.push_back(SearchPatchAt(pyramids_[v][k], maps_[v], pixel, scale_of(v, k)));
      }
      for (size_t s = 0; s < sources_[v].size(); ++s) {
        const auto source = static_cast<size_t>(sources_[v][s]);
        const auto expected = Shown(pixel, cameras[v], cameras[source], maps_[source]);
        if (!expected) continue;
        std::optional<Eigen::Vector2f> shift;
        Eigen::Vector2f offset(0, 0);  // full size
        for (size_t k = pairs[v][s].size(); k-- > 0;) {
          const PairLevel& level = pairs[v][s][k];
          shift.reset();
          if (!patches[k].IsSurface()) continue;
          const auto warped = WarpPatch(level.map, pixel, level.view_scale);
          if (!warped) continue;
          shift = FindPatch(patches[k], *warped, pyramids_[source][k], offset.cwiseQuotient(level.source_scale));
          if (shift) offset = shift->cwiseProduct(level.source_scale);
        }
        if (!shift) continue;
        const Eigen::Vector2d along = expected->by_inv_depth.normalized(), found = offset.cast<double>();
        slots[p * kOffsetSources + s] = PatchOffset{static_cast<int>(p), sources_[v][s], expected->at, found,
                                                    along.x() * found.y() - along.y() * found.x()};
      }
    }
  });
  std::vector<PatchOffset> offsets;
  for (const std::optional<PatchOffset>& slot : slots) {
    if (slot) offsets.push_back(*slot);
  }
  return offsets;
}

}  // namespace oraclegs
