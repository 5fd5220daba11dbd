#pragma once
// Matches that colmap verified between the images of a database, without any pose: those that one motion of the camera
// explains.

#include <filesystem>
#include <string>
#include <vector>

#include "oraclegs/sfm/colmap_database.h"
#include "oraclegs/sfm/homography.h"

namespace oraclegs {

/// Two images, by their names in the database (below images/), and the inliers between them.
struct VerifiedPair {
  std::string first, second;
  TwoViewConfig config = TwoViewConfig::kUndefined;
  std::vector<PointMatch> matches;  ///< pixels of the full-size images: a in `first`, b in `second`
};

/// Every pair with at least `min_matches` inliers, ordered by image id. Throws RunError naming the database when it
/// cannot be read, or when a pair's inliers are not among the keypoints of its images.
std::vector<VerifiedPair> ReadVerifiedMatches(const std::filesystem::path& database, int min_matches = 1);

}  // namespace oraclegs
