#pragma once
// The colmap program, run as a child process, finds poses for photos without any, and points of views whose poses
// are known.

#include <filesystem>
#include <vector>

#include "oraclegs/core/progress.h"
#include "oraclegs/scene/scene.h"
#include "oraclegs/sfm/colmap_quality.h"
#include "oraclegs/sfm/learned_features.h"

namespace oraclegs {

/// Poses for a plain folder of photos: feature extraction, exhaustive matching, mapper; the largest model wins. Images
/// of one size share one camera. Owns work_dir and writes images/ (links to the photos, as colmap sees them), masks/,
/// database.db, sparse/0, colmap.log, registration.json and, last, inputs.json (what the result depends on) there; a
/// finished model of the same photos is read instead of made again.
/// Returns a scene of format kColmap whose views are the registered photos, and reports to `listener` which photos
/// registered. Throws InputError when colmap is missing or fewer than two registered, naming those that failed and what
/// to retake.
/// `find_features` is asked, where it is given, when features of SIFT leave photos out; `confirmed_shares`, when
/// relaxed thresholds placed some, which are left out where no depth confirms them.
Scene RegisterViews(const Scene& photos, const std::filesystem::path& work_dir, const Listener& listener,
                    const FeatureFinder& find_features = {}, const ConfirmedShares& confirmed_shares = {});

/// Folders of TriangulatePoints.
struct TriangulationFolders {
  std::filesystem::path work;             ///< written
  std::filesystem::path registered = {};  ///< that RegisterViews wrote for the same photos, whose features and matches
                                          ///< are used; empty = none
};

/// Points triangulated from the given views only, with their poses held fixed (feature_extractor, exhaustive_matcher,
/// point_triangulator). Images are read where they are; nothing is written beside them. Owns folders.work and writes
/// images/ (links), masks/, database.db, sparse/0, points.ply, colmap.log and, last, inputs.json there; reused when
/// inputs.json (images, intrinsics, poses) is unchanged. Warns and returns no points when colmap is missing or fails.
std::vector<ScenePoint> TriangulatePoints(const Scene& scene, const std::vector<int>& views,
                                          const TriangulationFolders& folders, const Listener& listener);

/// The scene's own points (of a COLMAP model) that at least two of `views` saw: a point only one of them saw was
/// triangulated with the help of a held-out view.
std::vector<ScenePoint> PointsSeenBy(const Scene& scene, const std::vector<int>& views);

}  // namespace oraclegs
