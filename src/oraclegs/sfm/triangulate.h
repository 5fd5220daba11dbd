#pragma once
// Points of views whose poses are known, by the colmap program, run as a child process.

#include <filesystem>
#include <vector>

#include "oraclegs/core/progress.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {

/// Points triangulated from the given views only, with their poses held fixed (feature_extractor, exhaustive_matcher,
/// point_triangulator). Images are read where they are; nothing is written beside them. Owns work_dir and writes
/// images/ (links), masks/, database.db, sparse/0, points.ply, colmap.log and, last, inputs.json there; reused when
/// inputs.json (images, intrinsics, poses) is unchanged. Warns and returns no points when colmap is missing or fails.
std::vector<ScenePoint> TriangulatePoints(const Scene& scene, const std::vector<int>& views,
                                          const std::filesystem::path& work_dir, const Listener& listener);

/// The scene's own points (of a COLMAP model) that at least two of `views` saw: a point only one of them saw was
/// triangulated with the help of a held-out view.
std::vector<ScenePoint> PointsSeenBy(const Scene& scene, const std::vector<int>& views);

}  // namespace oraclegs
