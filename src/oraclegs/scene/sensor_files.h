#pragma once
// Depth that a sensor measured beside each photo, as the scene's files name it: a 16-bit gray PNG of depth along the
// optical axis (SceneView::depth_unit; 0 and 65535 = unknown), and a confidence that may come with it: an 8-bit PNG of
// levels up to 255, or 0 low, 1 medium, 2 high. Both have the photo's aspect and distortion, and any size.

#include "oraclegs/scene/scene.h"

namespace oraclegs {

/// Views that have a depth of a sensor.
size_t CountSensorDepth(const Scene& scene);

/// Whether no view has one, less than half of them have, or more.
enum class SensorDepth { kNone, kSome, kMost };
SensorDepth SensorDepthOf(const Scene& scene);

/// Looks at the headers of all depth and confidence files. Throws InputError naming the first that is something else,
/// or of another aspect than its photo.
void CheckSensorFiles(const Scene& scene);

}  // namespace oraclegs
