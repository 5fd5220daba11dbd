#pragma once
// Source-view selection and depth ranges of stereo (docs/method.md#stereo).

#include <vector>

#include "oraclegs/core/function_ref.h"
#include "oraclegs/depth/silhouettes.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {

/// Inclusive bounds of inverse depth, 1/world unit; near > far > 0.
struct DepthRange {
  float far = 0, near = 0;
};

/// Bounds for each view: from the points in its frame, with a margin. With fewer than 20 points, or with silhouettes,
/// from the cameras: +-45 % of the distance to the point they look at for an object within silhouettes, a fifth to
/// twenty times of it for a scene.
std::vector<DepthRange> FindDepthRanges(const std::vector<LoadedView>& views, const std::vector<ScenePoint>& points,
                                        const Silhouettes& silhouettes);

/// Up to `most` source views for each view, best first: those that see the same points (ScenePoint::views index
/// `views`) at an angle near 10 degrees, which is wide enough to measure and narrow enough to look similar; at least
/// half a degree and less than 60. Where two views share too few points, random ones in the volume that the cameras
/// look at are added. Empty for a view that shares points with no other, or only with views from its own place.
std::vector<std::vector<int>> FindNeighbors(const std::vector<LoadedView>& views, const std::vector<ScenePoint>& points,
                                            int most);

/// FindNeighbors of the views with `is_wanted`; the others have none.
std::vector<std::vector<int>> FindNeighbors(const std::vector<LoadedView>& views, const std::vector<ScenePoint>& points,
                                            int most, FunctionRef<bool(size_t)> is_wanted);

/// Indices, ascending, of the views whose depth is looked for: all of few, else kMaxStereoViews that are spread over
/// all places and directions.
std::vector<size_t> ViewsForStereo(const std::vector<Camera>& cameras);

/// Stereo of these takes about as long as training, and grows with them.
inline constexpr size_t kMaxStereoViews = 32;

/// Angle in degrees between the rays from two camera centers to a point.
double AngleAt(const Eigen::Vector3d& point, const Camera& a, const Camera& b);

}  // namespace oraclegs
