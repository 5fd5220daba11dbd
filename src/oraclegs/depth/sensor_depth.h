#pragma once
// Depth of a sensor, as the working cameras see it (docs/method.md#depth-of-a-sensor).

#include <vector>

#include "oraclegs/depth/depth_map.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {

/// Reads the depth that `view` has of a sensor (scene/sensor_files.h), in scene units / `unit` (the length of a unit of
/// the camera in scene units). A pixel's depth and normal are those of the plane through the measurements around, but
/// for those of other surfaces. Its confidence is 0 where the file's is low, less than kConfident beside an edge.
/// Throws InputError naming the file: unreadable, or of another aspect than its photo.
DepthMap ReadSensorDepth(const SceneView& view, const Camera& camera, double unit);

/// Reads that of the scene's views with these indices, on all threads; empty maps for those without. Throws
/// Interrupted, too.
std::vector<DepthMap> ReadSensorMaps(const Scene& scene, const std::vector<int>& views,
                                     const std::vector<Camera>& cameras, double unit);

}  // namespace oraclegs
