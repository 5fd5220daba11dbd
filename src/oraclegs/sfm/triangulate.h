#pragma once
// Structure from motion by the colmap program, run as a child process in the workspace.

#include <filesystem>
#include <vector>

#include "oraclegs/core/progress.h"
#include "oraclegs/scene/scene.h"
#include "oraclegs/scene/split.h"

namespace oraclegs {

/// True when the colmap program is installed.
bool ColmapAvailable();

/// Both functions below own their work_dir: each is given a folder of its own, which also gets images/ (links to the
/// photographs, as colmap sees them), masks/ and inputs.json (what the result depends on; written last).

/// Poses for a plain folder of photographs: feature extraction, exhaustive matching, mapper; the largest model wins.
/// Photographs of one size share one camera. Writes work_dir/{database.db,sparse/0,colmap.log}; a finished model of the
/// same photographs there is read instead of made again.
/// Returns a scene of format kColmap whose views are the registered photographs, and tells `listener` which of the n
/// photographs registered. Throws InputError when colmap is missing or fewer than two registered, naming those that
/// failed and what to retake.
Scene RegisterPhotos(const Scene& photos, const std::filesystem::path& work_dir, const Listener& listener);

/// Points triangulated from the given views only, with their poses held fixed (feature_extractor, exhaustive_matcher,
/// point_triangulator). Photographs are read where they are; nothing is written beside them. Writes
/// work_dir/{database.db,sparse/0,points.ply,colmap.log,inputs.json}; reused when inputs.json (images, lenses, poses)
/// is unchanged. Returns no points, with a warning told to `listener`, when colmap is missing or fails.
std::vector<ScenePoint> TriangulatePoints(const Scene& scene, const std::vector<int>& views,
                                          const std::filesystem::path& work_dir, const Listener& listener);

/// The scene's own points (of a COLMAP model) that at least two of `views` saw: a point only one of them saw was
/// triangulated with the help of a photograph that is held out.
std::vector<ScenePoint> PointsSeenBy(const Scene& scene, const std::vector<int>& views);

}  // namespace oraclegs
