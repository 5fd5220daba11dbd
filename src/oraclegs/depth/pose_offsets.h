#pragma once
// How far patches lie from where poses and depth put them (docs/method.md#pose-refinement). Along the epipolar line
// that is an error of depth; across it only poses and intrinsics can be wrong.

#include <Eigen/Core>
#include <vector>

#include "oraclegs/depth/depth_map.h"
#include "oraclegs/depth/patch_search.h"
#include "oraclegs/image/image.h"
#include "oraclegs/scene/loaded_view.h"

namespace oraclegs {

/// Where a source view shows the patch around a pixel.
struct PatchOffset {
  int pixel = 0;             ///< index of the OffsetPixel
  int source = 0;            ///< view
  Eigen::Vector2d expected;  ///< where poses and depth put the pixel, in the source image
  Eigen::Vector2d offset;    ///< where its patch is found, minus `expected`; pixels
  double across = 0;         ///< the offset's part across the epipolar line, signed
};

/// How far patches lie from their epipolar lines, pixels: single offsets are noisy, so the medians of |median across|
/// over cells, each a ninth of a view's image and a source view. Cells of few offsets are left out.
struct AcrossResidual {
  double all = 0;             ///< 0 without cells
  std::vector<double> views;  ///< of the cells of which each view is one of the two; 0 where they are few
  size_t cells = 0;
};
/// `cameras` are those of the views.
AcrossResidual ResidualAcross(const std::vector<OffsetPixel>& pixels, const std::vector<PatchOffset>& offsets,
                              const std::vector<Camera>& cameras);

/// Measures offsets between the views of one scene. The result does not depend on the number of threads.
class OffsetMeter {
 public:
  /// The maps correspond to the views, which must outlive the meter. Up to five source views for each view are those
  /// that see its confident pixels under the best angles (FindNeighbors).
  OffsetMeter(const std::vector<LoadedView>& views, const std::vector<DepthMap>& maps);

  /// Up to `most` confident pixels of each view, evenly drawn from those on a smooth surface with texture in two
  /// directions; sorted by view.
  std::vector<OffsetPixel> Choose(size_t most) const;

  /// Offsets of the pixels in the source views of their views, sorted by pixel, seen with these cameras. Patches are
  /// looked for from coarse to fine (FindPatch). Left out are those that are occluded, leave the image, or are not
  /// found.
  std::vector<PatchOffset> Measure(const std::vector<Camera>& cameras, const std::vector<OffsetPixel>& pixels) const;

  const std::vector<std::vector<int>>& sources() const { return sources_; }

 private:
  const std::vector<LoadedView>& views_;
  const std::vector<DepthMap>& maps_;
  std::vector<std::vector<int>> sources_;
  std::vector<std::vector<ImageF>> pyramids_;  ///< of each view: smoothed brightness, 8-bit units, full size first
};

}  // namespace oraclegs
