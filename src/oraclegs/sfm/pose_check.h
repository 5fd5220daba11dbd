#pragma once
// Whether the poses of a scene let depth be found, before any pixel is read.

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "oraclegs/core/progress.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {

/// One line for each way in which the poses of the training views keep depth from being found, each with how to fix it:
///   - views of one pose, by name;
///   - all camera centers in one place (farthest two closer than 1e-3 of the distance that is looked at);
///   - a view that shares hardly any of the volume it sees with another training view, by name.
/// The distance looked at is the median depth of the scene's points or, without points, of where optical axes meet.
/// `train_views` are indices into scene.views; views without a pose or intrinsics are passed over. Empty
/// for fewer than two posed views.
std::vector<std::string> PoseWarnings(const Scene& scene, const std::vector<int>& train_views);

/// Each view with the three that share most of the scene's points with it, as pairs of positions in `views`.
std::vector<std::pair<int, int>> NeighborsByPoints(const Scene& scene, const std::vector<int>& views);

/// Has colmap verify matches between such neighbors, a tenth of the work of TriangulatePoints, and leaves database.db
/// in work_dir, which it owns; reused when images, intrinsics and poses are unchanged. Notes that poses are not checked
/// where colmap is missing or fails.
void MatchForCheck(const Scene& scene, const std::vector<int>& views, const std::filesystem::path& work_dir,
                   const Listener& listener);

}  // namespace oraclegs
