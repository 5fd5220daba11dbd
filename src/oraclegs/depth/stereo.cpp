#include "oraclegs/depth/stereo.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/depth/patch_match.h"
#include "oraclegs/depth/plane_search.h"

namespace oraclegs {
namespace {

constexpr int kSourceViews = 5;          // of each view; more cost time and change little
constexpr int kMinCoarseSide = 60;       // pixels: below, halving leaves patches nothing to compare
constexpr int kGeometricIterations = 2;  // of a pass in which views must agree
constexpr int kMinLocalSide = 240;       // pixels: below, the coarser resolution misses too much, 0.1 dB of the splat
constexpr int kHintRadius = 1;           // pixels around a known point that start at its depth

class Stereo {
 public:
  Stereo(const std::vector<LoadedView>& views, const std::vector<ScenePoint>& points, const StereoOptions& options,
         PlaneSearch* search, const Listener& listener)
      : views_(views),
        points_(points),
        options_(options),
        search_(*search),
        listener_(listener),
        silhouettes_(views),
        ranges_(FindDepthRanges(views, points, silhouettes_)),
        neighbors_(FindNeighbors(views, points, kSourceViews)) {
    smallest_ = views.front().camera.width;
    for (const LoadedView& p : views) smallest_ = std::min({smallest_, p.camera.width, p.camera.height});
    levels_ = smallest_ >= 2 * kMinCoarseSide ? 2 : 1;
    const auto n = static_cast<int64_t>(views.size());
    total_ = n * levels_ * options.geometric_passes + n;
  }

  std::vector<DepthMap> Run() {
    WarnOfIsolated();
    std::vector<PlaneMap> maps;
    int pass = 0;
    for (int level = levels_ - 1; level >= 0; --level) {
      const StereoScene scene = SceneAt(level);
      const bool first = maps.empty(), local = !first && smallest_ >> level >= kMinLocalSide;
      for (size_t v = 0; v < views_.size(); ++v) {
        const Camera& camera = scene.views[v].camera;
        if (first) {
          maps.push_back(RandomPlanes(scene, v, Hints(scene, v)));
        } else {
          maps[v] = Resized(maps[v], camera.width, camera.height);
        }
      }
      search_.BeginLevel(scene, std::move(maps));
      if (first) ImproveAll(scene, {options_.iterations, pass++, false, false});
      for (int k = 0; k < options_.geometric_passes; ++k)
        ImproveAll(scene, {kGeometricIterations, pass++, true, local});
      maps = search_.EndLevel();
      if (level == 0) return Finish(scene, maps);
    }
    return {};
  }

 private:
  /// Whether colors are compared: those of an object before a plain background. Brightness is three times as fast.
  bool InColor() const { return !silhouettes_.empty(); }

  StereoScene SceneAt(int level) const {
    StereoScene scene;
    scene.silhouettes = &silhouettes_;
    scene.silhouette_scale = static_cast<float>(1 << level);
    for (size_t v = 0; v < views_.size(); ++v) {
      const LoadedView& loaded = views_[v];
      const int width = std::max(1, loaded.camera.width >> level), height = std::max(1, loaded.camera.height >> level);
      StereoView view{Resized(loaded.camera, width, height), {}, Usable(v, width, height), ranges_[v], neighbors_[v]};
      const ImageF small = level == 0 ? loaded.rgb : ResizeArea(loaded.rgb, width, height);
      view.image = Pack(InColor() ? small : Luma(small));
      scene.views.push_back(std::move(view));
    }
    return scene;
  }

  /// Unmasked pixels that show the object, at a resolution; empty = all.
  std::vector<uint8_t> Usable(size_t v, int width, int height) const {
    const LoadedView& loaded = views_[v];
    if (loaded.mask.empty() && silhouettes_.empty()) return {};
    std::vector<uint8_t> usable(static_cast<size_t>(width) * height);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const size_t from =
            static_cast<size_t>((2 * y + 1) * loaded.camera.height / (2 * height)) * loaded.camera.width +
            static_cast<size_t>((2 * x + 1) * loaded.camera.width / (2 * width));
        usable[static_cast<size_t>(y) * width + x] = (loaded.mask.empty() || loaded.mask[from] != 0) &&
                                                     (silhouettes_.empty() || silhouettes_.Object(v)[from] != 0);
      }
    }
    return usable;
  }

  /// Inverse depths of the points that view `v` saw, around their projections.
  std::vector<float> Hints(const StereoScene& scene, size_t v) const {
    const Camera& camera = scene.views[v].camera;
    std::vector<float> hints(static_cast<size_t>(camera.width) * camera.height, 0);
    for (const ScenePoint& point : points_) {
      if (std::find(point.views.begin(), point.views.end(), static_cast<int>(v)) == point.views.end()) continue;
      const Eigen::Vector3d p = camera.cam_from_world * point.xyz;
      if (!(p.z() > 0)) continue;
      const double u = camera.fx * p.x() / p.z() + camera.cx, v_image = camera.fy * p.y() / p.z() + camera.cy;
      if (!(u >= 0 && v_image >= 0 && u < camera.width && v_image < camera.height)) continue;
      const int x = static_cast<int>(u), y = static_cast<int>(v_image);
      for (int row = std::max(0, y - kHintRadius); row <= std::min(camera.height - 1, y + kHintRadius); ++row) {
        for (int column = std::max(0, x - kHintRadius); column <= std::min(camera.width - 1, x + kHintRadius);
             ++column) {
          hints[static_cast<size_t>(row) * camera.width + column] = static_cast<float>(1 / p.z());
        }
      }
    }
    return hints;
  }

  void ImproveAll(const StereoScene& scene, const SearchPass& pass) {
    search_.BeginPass(pass);
    for (size_t v = 0; v < scene.views.size(); ++v) {
      ThrowIfInterrupted();
      search_.Improve(v);
      const Camera& camera = scene.views[v].camera;
      listener_(StepDone{"depth", ++done_, total_, "passes", fmt::format("{} x {}", camera.width, camera.height)});
    }
  }

  std::vector<DepthMap> Finish(const StereoScene& scene, const std::vector<PlaneMap>& maps) const {
    std::vector<DepthMap> out;
    for (size_t v = 0; v < maps.size(); ++v) {
      ThrowIfInterrupted();
      const PlaneMap& map = maps[v];
      DepthMap depth{views_[v].name, views_[v].camera, {}, {}, Confidence(scene, v, maps)};
      depth.inv_depth.assign(map.planes.size(), 0);
      depth.normals.assign(map.planes.size(), Eigen::Vector3f::Zero());
      ParallelFor(map.height, [&](int64_t y) {
        for (int x = 0; x < map.width; ++x) {
          const size_t i = static_cast<size_t>(y) * map.width + x;
          if (!(depth.confidence[i] > 0)) continue;
          depth.inv_depth[i] = map.planes[i].inv_depth;
          depth.normals[i] =
              NormalOf(depth.camera, map.planes[i], static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
        }
      });
      out.push_back(std::move(depth));
    }
    return out;
  }

  void WarnOfIsolated() const {
    std::vector<std::string> names;
    for (size_t v = 0; v < views_.size(); ++v) {
      if (neighbors_[v].empty()) names.push_back(views_[v].name);
    }
    if (names.empty()) return;
    listener_(Warning{fmt::format(
        "no depth can be found for photos that overlap with no other, or were taken from the same point: {}",
        fmt::join(names, ", "))});
  }

  const std::vector<LoadedView>& views_;
  const std::vector<ScenePoint>& points_;
  const StereoOptions& options_;
  PlaneSearch& search_;
  const Listener& listener_;
  Silhouettes silhouettes_;
  std::vector<DepthRange> ranges_;
  std::vector<std::vector<int>> neighbors_;
  int smallest_ = 0;  ///< smallest side of all views, pixels
  int levels_ = 1;
  int64_t done_ = 0, total_ = 0;
};

/// The points with those of the views that are among `chosen`, by their places there.
std::vector<ScenePoint> SeenBy(const std::vector<size_t>& chosen, std::vector<ScenePoint> points) {
  for (ScenePoint& point : points) {
    std::vector<int> views;
    for (const int v : point.views) {
      const auto place = std::lower_bound(chosen.begin(), chosen.end(), static_cast<size_t>(v));
      if (place == chosen.end() || *place != static_cast<size_t>(v)) continue;
      views.push_back(static_cast<int>(place - chosen.begin()));
    }
    point.views = std::move(views);
  }
  return points;
}

}  // namespace

std::vector<DepthMap> EstimateDepth(const std::vector<LoadedView>& views, const std::vector<ScenePoint>& points,
                                    const StereoOptions& options, PlaneSearch* search, const Listener& listener) {
  if (views.empty()) return {};
  const std::vector<size_t> chosen = ViewsForStereo(CamerasOf(views));
  if (chosen.size() == views.size()) return Stereo(views, points, options, search, listener).Run();
  std::vector<LoadedView> of_stereo;
  for (const size_t v : chosen) of_stereo.push_back(views[v]);
  std::vector<DepthMap> found = Stereo(of_stereo, SeenBy(chosen, points), options, search, listener).Run();
  std::vector<DepthMap> maps;
  for (const LoadedView& view : views) maps.push_back({view.name, view.camera, {}, {}, {}});
  for (size_t k = 0; k < chosen.size(); ++k) maps[chosen[k]] = std::move(found[k]);
  return maps;
}

}  // namespace oraclegs
