#pragma once
// How much of the views other views see, and how much of that became depth.

#include <vector>

#include "oraclegs/depth/depth_map.h"
#include "oraclegs/depth/silhouettes.h"
#include "oraclegs/scene/loaded_view.h"

namespace oraclegs {

/// Shares of the pixels of all views that are neither masked nor plain background.
struct Overlap {
  double seen = 0;       ///< whose point another view has in frame, from at most 75 degrees aside
  double confident = 0;  ///< of those that are seen so
};

/// Takes every eighth pixel, at the depth that its map has there, right or wrong, or else at the map's median. `views`
/// and `silhouettes` belong to `maps`.
Overlap MeasureOverlap(const std::vector<DepthMap>& maps, const std::vector<LoadedView>& views,
                       const Silhouettes& silhouettes);

}  // namespace oraclegs
