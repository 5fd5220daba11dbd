#pragma once
// Features that a network finds, beside those of SIFT, in colmap's database.

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "oraclegs/core/buffer.h"
#include "oraclegs/core/progress.h"
#include "oraclegs/image/image.h"
#include "oraclegs/sfm/colmap_runner.h"

namespace oraclegs {

struct LearnedFeatures {
  std::vector<Eigen::Vector2f> keypoints;  ///< pixels from the image's top-left corner
  Buffer<float> descriptors;               ///< [keypoints, size] of unit length, on the host
};

/// Finds the features of an RGB image.
using FeatureFinder = std::function<LearnedFeatures(const ImageF& rgb)>;

/// Adds learned features to all images of a database in which colmap has matched features of SIFT, matches each image
/// with every other, and lets colmap verify both kinds of matches together. Keypoints on masked pixels are left out.
/// Throws ColmapFailure, RunError naming the database, InputError for an image that cannot be read, Interrupted.
void AddLearnedFeatures(const ColmapRunner& colmap, const FeatureFinder& find, const Listener& listener);

}  // namespace oraclegs
