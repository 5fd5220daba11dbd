#pragma once
// PatchMatch stereo over planes in inverse depth, one view against its neighbours.
// Barnes et al., "PatchMatch" (SIGGRAPH 2009) for the search; Bleyer et al., "PatchMatch Stereo" (BMVC 2011) for
// slanted planes; Galliani et al., "Massively Parallel Multiview Stereopsis by Surface Normal Diffusion" (ICCV 2015)
// for the chessboard; Xu and Tao, "Multi-Scale Geometric Consistency Guided Multi-View Stereo" (CVPR 2019) for the
// sampling of neighbours, the views' weights and the geometric term.

#include <cstdint>
#include <vector>

#include "oraclegs/depth/patch_cost.h"
#include "oraclegs/depth/silhouettes.h"
#include "oraclegs/depth/stereo_setup.h"

namespace oraclegs {

/// What PatchMatch knows of every pixel of one view.
struct PlaneMap {
  int width = 0, height = 0;
  std::vector<Plane> planes;  ///< inverse depth 0 = nothing is known
  std::vector<float> costs;   ///< [0, kWorstCost], without the geometric term

  const Plane& At(int x, int y) const { return planes[static_cast<size_t>(y) * width + x]; }
};

/// One view at one resolution.
struct StereoView {
  Camera camera;
  PackedImage image;
  std::vector<uint8_t> usable;  ///< height * width, 1 = take part; empty = all
  DepthRange range;
  std::vector<int> neighbors;  ///< indices of views
};

/// What a pass over one view reads and never changes.
struct StereoScene {
  std::vector<StereoView> views;
  const Silhouettes* silhouettes = nullptr;  ///< may be null or empty; of pictures `silhouette_scale` times as large
  float silhouette_scale = 1;
};

/// Random planes within the range; a pixel whose inverse depth is known (`hints`, height * width, 0 = unknown, may be
/// empty) starts there, facing the camera. Costs are kWorstCost.
PlaneMap RandomPlanes(const StereoScene& scene, size_t view, const std::vector<float>& hints);

/// Carries a map to another resolution of the same view.
PlaneMap Resized(const PlaneMap& map, int width, int height);

struct PassOptions {
  int iterations = 3;
  int pass = 0;  ///< number of the pass; no two of a view share their random numbers
  /// The maps of all views as the pass before left them, for the geometric term; null = photometric only.
  const std::vector<PlaneMap>* geometry = nullptr;
};

/// Improves the map of one view in place, on all threads. The same bits for any number of threads.
void RunPass(const StereoScene& scene, size_t view, const PassOptions& options, PlaneMap* map);

/// Where the pixel (u, v) with inverse depth w of one view lands when it is carried to another view and back with the
/// depth that is known there.
struct RoundTrip {
  bool seen = false;         ///< in the other picture, where something is known
  float pixels = 0;          ///< distance from the start
  float relative_depth = 0;  ///< depth there, of the point / of the surface known there, minus 1: > 0 is hidden
};
RoundTrip GoAndReturn(const PixelMap& there, const PixelMap& back, const PlaneMap& other, const Eigen::Vector3f& uvw);

}  // namespace oraclegs
