#pragma once
// Overlap of the views, and how much of it became depth.

#include <vector>

#include "oraclegs/depth/depth_map.h"
#include "oraclegs/depth/silhouettes.h"
#include "oraclegs/scene/loaded_view.h"

namespace oraclegs {

/// Fractions over the pixels of all views that are neither masked nor plain background.
struct Overlap {
  double seen = 0;  ///< pixels whose point another view has in frame, at most 75 degrees aside, as a fraction of all
  double confident = 0;  ///< confident pixels as a fraction of the seen ones
};

/// Measures every eighth pixel, at its depth in its map, right or wrong, or else at the map's median. `views` and
/// `silhouettes` correspond to `maps`.
Overlap MeasureOverlap(const std::vector<DepthMap>& maps, const std::vector<LoadedView>& views,
                       const Silhouettes& silhouettes);

}  // namespace oraclegs
