#pragma once
// One vector for each image, by its features: images that show the same things have alike ones.

#include <Eigen/Core>
#include <filesystem>
#include <vector>

#include "oraclegs/sfm/matched_features.h"

namespace oraclegs {

/// Vectors of locally aggregated descriptors [Jegou 2010], one a row, of unit length: of each of 32 clusters of the
/// descriptors of all images, where the image's differ from its center. A row of zeros for an image without features.
/// Deterministic: equal descriptors give equal bits.
Eigen::MatrixXf DescribeImages(const std::vector<DescriptorMatrix>& images);

}  // namespace oraclegs
