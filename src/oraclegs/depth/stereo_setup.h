#pragma once
// What stereo must know before it looks at pixels: whom to compare with whom, and at what distances.

#include <vector>

#include "oraclegs/depth/silhouettes.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {

/// Inclusive bounds of inverse depth, 1/world unit; near > far > 0.
struct DepthRange {
  float far = 0, near = 0;
};

/// Bounds for each photograph: from the points it sees (ScenePoint::views index `photos`), with a margin; where they
/// are fewer than 20, or there are silhouettes, from the cameras: the distance to what they look at, +-45 % for an
/// object within silhouettes, from a fifth of it to far beyond for a scene.
std::vector<DepthRange> FindDepthRanges(const std::vector<LoadedView>& photos, const std::vector<ScenePoint>& points,
                                        const Silhouettes& silhouettes);

/// For each photograph up to `most` others to compare it with, best first: those that see the same points under an
/// angle near 10 degrees, which is wide enough to measure and narrow enough to look alike, at least half a degree and
/// less than
/// 60. Points stand in for the scene where two photographs share too few: drawn in the volume the cameras look at. May
/// be empty for a photograph that shares nothing with any other, or only with those taken from its own place.
std::vector<std::vector<int>> FindNeighbors(const std::vector<LoadedView>& photos,
                                            const std::vector<ScenePoint>& points, int most);

/// Angle in degrees under which two camera centres see a point.
double AngleAt(const Eigen::Vector3d& point, const Camera& a, const Camera& b);

}  // namespace oraclegs
