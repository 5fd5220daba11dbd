#pragma once
// PatchMatch stereo over planes in inverse depth, one reference view against its source views (docs/method.md#stereo):
// [Barnes 2009] for the search, [Bleyer 2011] for slanted planes, [Galliani 2015] for red-black propagation, [Xu 2019]
// for the sampling of neighbors, the weights of source views and the geometric term.

#include <cstdint>
#include <vector>

#include "oraclegs/depth/patch_cost.h"
#include "oraclegs/depth/search_math.h"
#include "oraclegs/depth/silhouettes.h"
#include "oraclegs/depth/stereo_setup.h"

namespace oraclegs {

/// The plane of every pixel of one view.
struct PlaneMap {
  int width = 0, height = 0;
  std::vector<Plane> planes;  ///< inverse depth 0 = unknown
  std::vector<float> costs;   ///< [0, kWorstCost], without the geometric term

  const Plane& At(int x, int y) const { return planes[static_cast<size_t>(y) * width + x]; }
};
inline KnownPlanes Known(const PlaneMap& map) { return {map.planes.data(), map.width, map.height}; }

/// One view at one resolution.
struct StereoView {
  Camera camera;
  GatherImage image;
  std::vector<uint8_t> usable;  ///< height * width, 1 = used; empty = all used
  DepthRange range;
  std::vector<int> neighbors;  ///< source views, indices
};

/// Inputs of a pass over one view, which it never changes.
struct StereoScene {
  std::vector<StereoView> views;
  const Silhouettes* silhouettes = nullptr;  ///< may be null or empty; of images `silhouette_scale` times as large
  float silhouette_scale = 1;
};

/// Random planes within the range. A pixel whose inverse depth is known (`hints`, height * width, 0 = unknown, may be
/// empty) starts there, facing the camera. Costs are kWorstCost.
PlaneMap RandomPlanes(const StereoScene& scene, size_t view, const std::vector<float>& hints);

/// Resamples a map to another resolution of the same view.
PlaneMap Resized(const PlaneMap& map, int width, int height);

struct PassOptions {
  int iterations = 3;
  int pass = 0;  ///< number of the pass, unique per view, as it selects the random numbers
  /// Maps of all views after the pass before, for the geometric term; null = photometric only.
  const std::vector<PlaneMap>* geometry = nullptr;
  bool local = false;  ///< as SearchPass::local
};

/// Inputs of the search of a view on any device, except for its pass and its pointers to the scene and the maps, which
/// are null. At most kMaxSources neighbors are used.
SearchView SearchOf(const StereoScene& scene, size_t view);
/// Silhouettes of all other views with the map there from this view, in the memory of the scene; empty without an
/// object.
std::vector<SearchSilhouette> SilhouettesFor(const StereoScene& scene, size_t view);

/// Improves the map of one view in place, on all threads. The result does not depend on the number of threads.
void RunPass(const StereoScene& scene, size_t view, const PassOptions& options, PlaneMap* map);

// Depth confidence (docs/method.md#depth-confidence).

/// Confidence of each pixel's depth in one view, [0, 1], from the finished maps of all views. It is high where other
/// views found the same surface from angles wide enough to measure, where patches are similar, and where no other view
/// sees through the point. Pixels that differ from their surroundings, and islands of few pixels, get little.
std::vector<float> Confidence(const StereoScene& scene, size_t view, const std::vector<PlaneMap>& maps);

}  // namespace oraclegs
