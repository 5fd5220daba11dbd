#pragma once
// Which pairs of many images are matched: all of few; of many, those next in order and those that look alike.

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "oraclegs/sfm/colmap_runner.h"
#include "oraclegs/sfm/matched_features.h"

namespace oraclegs {

inline constexpr int kMaxImagesToMatchAll = 60;  ///< all pairs of more take longer than finding their cameras

/// How many pairs of so many images are matched, at most.
int64_t PairsToMatch(int images);

/// The pairs (i, j), i < j, of images in the order of their names: each with its kNextInOrder next ones and the
/// kMaxAlike most alike ones by their descriptions, one a row, of unit length (a row of zeros is like none).
std::vector<std::pair<int, int>> ChoosePairs(const Eigen::MatrixXf& descriptions);

inline constexpr int kNextInOrder = 4, kMaxAlike = 10;

/// Matches the images of colmap's database: all pairs of at most kMaxImagesToMatchAll, else chosen ones, which
/// it is reported to `listener`.
void MatchImages(const ColmapRunner& colmap, const ColmapOptions& options, const Listener& listener);

/// Vectors of locally aggregated descriptors [Jegou 2010], one a row, of unit length: of each of 32 clusters of the
/// descriptors of all images, where the image's differ from its center. A row of zeros for an image without features.
/// Deterministic: equal descriptors give equal bits.
Eigen::MatrixXf DescribeImages(const std::vector<DescriptorMatrix>& images);

}  // namespace oraclegs
