#pragma once
// Matches for checking given poses where nothing else needs matches: few features, and neighbors alone.

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "oraclegs/core/progress.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {

/// Each view with the three that share most of the scene's points with it, as pairs of positions in `views`.
std::vector<std::pair<int, int>> NeighborsByPoints(const Scene& scene, const std::vector<int>& views);

/// Has colmap verify matches between such neighbors, a tenth of the work of TriangulatePoints, and leaves database.db
/// in work_dir, which it owns; reused when images, intrinsics and poses are unchanged. Notes that poses are not checked
/// where colmap is missing or fails.
void MatchForCheck(const Scene& scene, const std::vector<int>& views, const std::filesystem::path& work_dir,
                   const Listener& listener);

}  // namespace oraclegs
