#pragma once
// The features of COLMAP's database: where those that match lie, what they look like, and which of them
// colmap verified, without any pose: those that one motion of the camera explains.

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "oraclegs/sfm/colmap_database.h"
#include "oraclegs/sfm/homography.h"

namespace oraclegs {

/// Where the inliers of that pair (first < second) lie, in pixels: a in `first`, b in `second`. Empty when the pair was
/// not verified, or when its lists and the images' keypoints do not fit together. Throws RunError naming the database.
std::vector<PointMatch> ReadInliers(const std::filesystem::path& database, uint32_t first, uint32_t second);

/// The features of that pair that look alike and are no inliers, as ReadInliers returns those.
std::vector<PointMatch> ReadOutliers(const std::filesystem::path& database, uint32_t first, uint32_t second);

using DescriptorMatrix = Eigen::Matrix<float, Eigen::Dynamic, 128, Eigen::RowMajor>;

/// The descriptors, of values from 0 to 255, of the largest features of an image, at most `most`. Empty when it has
/// none or a damaged list. Throws RunError naming the database.
DescriptorMatrix ReadLargestDescriptors(const std::filesystem::path& database, uint32_t image_id, int most);

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
