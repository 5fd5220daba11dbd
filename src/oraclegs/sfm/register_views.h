#pragma once
// Poses for photos without any, by the colmap program, run as a child process.

#include <filesystem>

#include "oraclegs/core/progress.h"
#include "oraclegs/scene/scene.h"
#include "oraclegs/sfm/learned_features.h"

namespace oraclegs {

/// Poses for a plain folder of photos: feature extraction, exhaustive matching, mapper; the largest model wins. Images
/// of one size share one camera. Owns work_dir and writes images/ (links to the photos, as colmap sees them), masks/,
/// database.db, sparse/0, colmap.log, registration.json and, last, inputs.json (what the result depends on) there; a
/// finished model of the same photos is read instead of made again.
/// Returns a scene of format kColmap whose views are the registered photos, and reports to `listener` which photos
/// registered. Throws InputError when colmap is missing or fewer than two registered, naming those that failed and what
/// to retake.
/// `find_features` is asked, where it is given, when features of SIFT leave photos out.
Scene RegisterViews(const Scene& photos, const std::filesystem::path& work_dir, const Listener& listener,
                    const FeatureFinder& find_features = {});

}  // namespace oraclegs
