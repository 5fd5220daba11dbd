#pragma once
// Points of which nothing says which photos saw them: of a LiDAR, a network, another program.

#include <string>
#include <vector>

#include "oraclegs/core/progress.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {

/// Gives points[i], for each i of `which`, the views of the scene into whose image it falls. All views have poses.
void FindViewsOfPoints(const std::vector<size_t>& which, const Scene& scene, std::vector<ScenePoint>* points);

/// A note that `count` of the `total` points of `source` have no tracks, and what they are used for; none for 0.
void ReportUntracked(const std::string& source, size_t count, size_t total, const Listener& listener);

/// A warning that so many of the points of `source` are left out; none for 0.
void ReportPointsLeftOut(const std::string& source, size_t count, size_t total, const Listener& listener);

}  // namespace oraclegs
