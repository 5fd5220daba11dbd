#pragma once
// The features of COLMAP's database: where those that match lie, and what they look like.

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <vector>

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

}  // namespace oraclegs
