#pragma once
// Bundle adjustment of patches: poses, and the inverse depth of each pixel, that explain measured offsets
// (docs/method.md#pose-refinement).

#include <vector>

#include "oraclegs/depth/pose_offsets.h"
#include "oraclegs/depth/reprojection.h"

namespace oraclegs {

/// Poses and depths that are adjusted. The first camera and the length of the longest baseline stay.
struct AdjustedScene {
  std::vector<Camera> cameras;
  std::vector<OffsetPixel> pixels;  ///< sorted by view; their inverse depths follow
};

/// Moves `scene` to a minimum of the robust sum of squared distances between where pixels are expected and where they
/// were found, `offsets` of these pixels in this scene. Poses are held at those of `given` by weak priors; intrinsics
/// stay. The result does not depend on the number of threads.
void AdjustScene(const std::vector<PatchOffset>& offsets, const std::vector<Camera>& given, AdjustedScene* scene);

}  // namespace oraclegs
