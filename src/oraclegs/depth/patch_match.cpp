#include "oraclegs/depth/patch_match.h"

#include <algorithm>

#include "oraclegs/core/parallel.h"

namespace oraclegs {
namespace {

constexpr int kRowsPerTask = 2;

}  // namespace

SearchView SearchOf(const StereoScene& scene, size_t view) {
  const StereoView& v = scene.views[view];
  SearchView search;
  search.width = v.camera.width, search.height = v.camera.height;
  search.fx = static_cast<float>(v.camera.fx), search.fy = static_cast<float>(v.camera.fy);
  search.cx = static_cast<float>(v.camera.cx), search.cy = static_cast<float>(v.camera.cy);
  search.far = v.range.far, search.near = v.range.near;
  search.view = static_cast<int>(view);
  search.silhouette_scale = scene.silhouette_scale;
  for (const int n : v.neighbors) {
    if (search.num_sources == kMaxSources) break;
    const Camera& other = scene.views[static_cast<size_t>(n)].camera;
    search.sources[search.num_sources++] = {
        Plain(MapBetween(v.camera, other)), Plain(MapBetween(other, v.camera)), {nullptr, other.width, other.height}};
  }
  return search;
}

std::vector<SearchSilhouette> SilhouettesFor(const StereoScene& scene, size_t view) {
  std::vector<SearchSilhouette> silhouettes;
  if (scene.silhouettes == nullptr || scene.silhouettes->empty()) return silhouettes;
  for (size_t v = 0; v < scene.views.size(); ++v) {
    if (v == view) continue;
    silhouettes.push_back(
        {Plain(MapBetween(scene.views[view].camera, scene.views[v].camera)), scene.silhouettes->Mask(v)});
  }
  return silhouettes;
}

PlaneMap RandomPlanes(const StereoScene& scene, size_t view, const std::vector<float>& hints) {
  const StereoView& v = scene.views[view];
  PlaneMap map{v.camera.width, v.camera.height, {}, {}};
  const size_t pixels = static_cast<size_t>(map.width) * static_cast<size_t>(map.height);
  map.planes.resize(pixels);
  map.costs.assign(pixels, kWorstCost);
  SearchView search = SearchOf(scene, view);
  search.pass = 63;  // beyond the passes of a run
  for (size_t i = 0; i < pixels; ++i) {
    if (!v.usable.empty() && v.usable[i] == 0) continue;
    PixelRandom random(search, 0, static_cast<int64_t>(i));
    if (!hints.empty() && hints[i] > 0) {
      map.planes[i] = {hints[i], 0, 0};
      continue;
    }
    map.planes[i].inv_depth = RandomInverseDepth(search, &random);
    Tilt(search, &random, &map.planes[i]);
  }
  return map;
}

PlaneMap Resized(const PlaneMap& map, int width, int height) {
  PlaneMap out{width, height, {}, {}};
  const float sx = static_cast<float>(map.width) / static_cast<float>(width);
  const float sy = static_cast<float>(map.height) / static_cast<float>(height);
  out.planes.reserve(static_cast<size_t>(width) * height);
  out.costs.reserve(out.planes.capacity());
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float u = (static_cast<float>(x) + 0.5f) * sx, v = (static_cast<float>(y) + 0.5f) * sy;
      const int ox = std::min(static_cast<int>(u), map.width - 1), oy = std::min(static_cast<int>(v), map.height - 1);
      const Plane& p = map.At(ox, oy);
      const float at = p.At(u - static_cast<float>(ox) - 0.5f, v - static_cast<float>(oy) - 0.5f);
      out.planes.push_back({std::max(at, 0.f), p.dx * sx, p.dy * sy});
      out.costs.push_back(map.costs[static_cast<size_t>(oy) * map.width + ox]);
    }
  }
  return out;
}

void RunPass(const StereoScene& scene, size_t view, const PassOptions& options, PlaneMap* map) {
  const StereoView& v = scene.views[view];
  const std::vector<SearchSilhouette> silhouettes = SilhouettesFor(scene, view);
  SearchView search = SearchOf(scene, view);
  if (search.num_sources == 0) return;
  search.pass = options.pass;
  search.local = options.local;
  search.usable = v.usable.empty() ? nullptr : v.usable.data();
  search.planes = map->planes.data();
  search.costs = map->costs.data();
  search.silhouettes = silhouettes.data();
  search.num_silhouettes = static_cast<int>(silhouettes.size());
  std::vector<PatchSource> sources;
  for (int s = 0; s < search.num_sources; ++s) {
    const auto n = static_cast<size_t>(v.neighbors[static_cast<size_t>(s)]);
    sources.push_back({&scene.views[n].image, MapBetween(v.camera, scene.views[n].camera)});
    if (options.geometry != nullptr) search.sources[s].known = Known((*options.geometry)[n]);
  }
  const auto improve = [&](int x, int y, int iteration) {
    if (!search.IsUsable(x, y)) return;
    const Patch patch = MakePatch(v.image, x, y, search.usable);
    const auto costs_of = [&](const Plane* planes, int count, const uint8_t* active, float* costs) {
      PatchCosts(patch, {sources, active, {planes, static_cast<size_t>(count)}}, costs);
    };
    PixelSearch(search, x, y, costs_of).Improve(iteration);
  };
  const int rows = (map->height + kRowsPerTask - 1) / kRowsPerTask;
  for (int iteration = 0; iteration < options.iterations; ++iteration) {
    for (int color = 0; color < 2; ++color) {
      ParallelFor(rows, [&](int64_t task) {
        const int begin = static_cast<int>(task) * kRowsPerTask;
        for (int y = begin; y < std::min(map->height, begin + kRowsPerTask); ++y) {
          for (int x = (y + color) % 2; x < map->width; x += 2) improve(x, y, iteration);
        }
      });
    }
  }
}

}  // namespace oraclegs
