#pragma once
// A sensor's depth, scaled, beside stereo's (docs/method.md#depth-of-a-sensor).

#include <string>
#include <vector>

#include "oraclegs/core/progress.h"
#include "oraclegs/depth/align.h"
#include "oraclegs/depth/depth_map.h"
#include "oraclegs/depth/monocular.h"
#include "oraclegs/depth/silhouettes.h"
#include "oraclegs/scene/loaded_view.h"

namespace oraclegs {

/// The relation of the sensor's depths to known ones.
struct SensorFit {
  double scale = 1;          ///< times which the sensor's depths are the scene's
  size_t checked = 0;        ///< views that had enough known depths; without any, the scale is that of the files
  double right = 1;          ///< share of the known depths that the scaled ones of used views get right (kRightWithin)
  std::vector<bool> fits{};  ///< for each view: its own scale is not unlike that of the others
  /// True unless most of the checked views have scales of their own, or most of the known depths are not met.
  bool is_usable = true;
};
SensorFit FitSensor(const std::vector<DepthMap>& sensor, const std::vector<std::vector<KnownDepth>>& known);

/// Combines stereo's map and the sensor's, scaled. Where only one is known it is taken. Where stereo is confident its
/// depth stays, unless the sensor contradicts it (more than kRightWithin) and is not beside an edge; elsewhere the one
/// of more confidence is taken. The sensor's confidence is multiplied by `fit.right` first; two that agree are surer
/// than one. `stereo` may be empty, and so may the sensor's map. `used`: share of the pixels with the sensor's depth.
DepthMap WithSensorDepth(DepthMap stereo, const DepthMap& sensor, const SensorFit& fit, const AllowedPixels& allowed,
                         double* used);

/// Combined maps, and what was found.
struct SensorMaps {
  std::vector<DepthMap> maps;
  SensorFit fit;
  size_t views = 0;  ///< whose sensor is used
  double used = 0;   ///< share of all views' pixels with the sensor's depth
};

/// Views, what bounds them, and their sparse points (ScenePoint::views index `views`).
struct SensorScene {
  const std::vector<LoadedView>& views;
  const Silhouettes& silhouettes;
  const std::vector<ScenePoint>& points;
};

/// Combines the maps of all views, stereo's (empty where it left a view out) and the sensor's (empty for a view
/// without), which are scaled to the points, or to stereo where a view has few. Warns of views whose sensor saw
/// nothing, or has another scale than the other views', which keep stereo's; and where the sensor fits nowhere, so that
/// all do.
SensorMaps CombineWithSensor(const SensorScene& scene, const std::vector<DepthMap>& sensor,
                             std::vector<DepthMap> stereo, const Listener& listener);

}  // namespace oraclegs
