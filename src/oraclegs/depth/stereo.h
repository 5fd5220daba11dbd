#pragma once
// Multi-view stereo: dense depth from posed views, without any network (docs/method.md#stereo).

#include <cstdint>
#include <vector>

#include "oraclegs/core/progress.h"
#include "oraclegs/depth/depth_map.h"
#include "oraclegs/scene/loaded_view.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {

class PlaneSearch;

struct StereoOptions {
  int iterations = 5;
  int geometric_passes = 2;
};

/// Depth maps of the views, in their order, empty for those not in ViewsForStereo: coarse-to-fine PatchMatch, then
/// passes in which the views must agree. `points` (ScenePoint::views index `views`) give distances and source views
/// where there are any; without them the cameras do. Silhouettes, where the images show one object before a plain
/// background, bound every depth. Pixels that cannot be known (no texture, no overlap, mirrors, sky) come out with
/// little or no confidence. `search` searches the planes on its device; the rest runs on the CPU. `listener` gets
/// StepDone{"depth"}, and a warning that names views that overlap with no other. The result does not depend on the
/// number of threads. Throws Interrupted and the errors of `search`.
std::vector<DepthMap> EstimateDepth(const std::vector<LoadedView>& views, const std::vector<ScenePoint>& points,
                                    const StereoOptions& options, PlaneSearch* search, const Listener& listener);

}  // namespace oraclegs
