#pragma once
// The little of COLMAP's SQLite database that is read and written here: its images, cameras, features and matches.

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "oraclegs/camera/intrinsics.h"
#include "oraclegs/sfm/match_descriptors.h"

namespace oraclegs {

struct DatabaseImage {
  uint32_t image_id = 0;
  uint32_t camera_id = 0;
};

/// The images table by name. Throws RunError naming the database when it cannot be read.
std::map<std::string, DatabaseImage> ReadDatabaseImages(const std::filesystem::path& database);

/// Features found in each image, by image id; 0 for an image without an entry. Throws RunError naming the database.
std::map<uint32_t, int> ReadFeatureCounts(const std::filesystem::path& database);

/// How colmap explains what it verified between two images: its word config, by its numbers.
enum class TwoViewConfig {
  kUndefined = 0,
  kDegenerate = 1,
  kCalibrated = 2,    ///< an essential matrix, of the cameras that stand in the database
  kUncalibrated = 3,  ///< a fundamental matrix: the focal lengths in the database do not matter
  kPlanar = 4,
  kPanoramic = 5,
  kPlanarOrPanoramic = 6,
  kWatermark = 7,
  kMultiple = 8,
};

/// Two images that colmap matched.
struct MatchedPair {
  uint32_t first = 0, second = 0;  ///< image ids, first < second
  int matches = 0;                 ///< features that look alike
  int inliers = 0;                 ///< matches that one motion of the camera explains; 0 = not verified
  TwoViewConfig config = TwoViewConfig::kUndefined;
  /// Pixel of `second` from pixel of `first`, where such a map explains the inliers: the images show one plane, or
  /// were taken from one point. As RANSAC left it: RefitHomography makes it exact.
  std::optional<Eigen::Matrix3d> homography;
};

/// Every pair that was matched, ordered by (first, second). Throws RunError naming the database, also for a pair that
/// is not one of two images.
std::vector<MatchedPair> ReadMatchedPairs(const std::filesystem::path& database);

/// The features of two images that look alike, by their indices in each; a is of `first`, the smaller id. Empty when
/// they were not matched, or the list is damaged. Throws RunError naming the database.
std::vector<FeatureMatch> ReadMatches(const std::filesystem::path& database, uint32_t first, uint32_t second);

/// Writes keypoints, in pixels, behind those of an image, with a size of one pixel; returns how many it had. They get
/// no descriptors: colmap cannot match them. Throws RunError naming the database.
int AppendKeypoints(const std::filesystem::path& database, uint32_t image_id,
                    const std::vector<Eigen::Vector2f>& keypoints);

/// Removes what was found between those pairs of image ids, so that colmap matches them again. Throws RunError.
void RemoveMatches(const std::filesystem::path& database, const std::vector<std::pair<uint32_t, uint32_t>>& pairs);

/// Replaces the cameras of those ids, marked as calibrated. Throws RunError naming the database.
void SetDatabaseCameras(const std::filesystem::path& database, const std::map<uint32_t, Intrinsics>& cameras);

/// Lets the focal length of the SIMPLE_RADIAL cameras of these images, by name, start where EXIF says, in pixels, and
/// marks it as known. Throws RunError naming the database.
void SetFocalPriors(const std::filesystem::path& database, const std::map<std::string, double>& focal_of_image);

/// Lets the focal length of each SIMPLE_RADIAL camera whose own is not known (no EXIF) start at `sides` longer sides of
/// the image; returns how many there are. Throws RunError naming the database.
int SetFocalGuess(const std::filesystem::path& database, double sides);

/// Numbers the images 1, 2, ... in the order of their names, before there are matches: colmap numbers them as its
/// threads finish, and what follows depends on the numbers. Throws RunError naming the database.
void NumberImagesByName(const std::filesystem::path& database);

}  // namespace oraclegs
