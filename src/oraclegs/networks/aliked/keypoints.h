#pragma once
// Keypoints out of a map of scores: local maxima, refined between the pixels [Zhao 2022].

#include <Eigen/Core>
#include <vector>

#include "oraclegs/networks/common/tensor.h"
#include "oraclegs/networks/networks.h"

namespace oraclegs::aliked {

struct Keypoint {
  Eigen::Vector2f place;  ///< columns and rows from the center of the first pixel
  float score = 0;        ///< of the map at that place
};

/// The pixels that beat all others within two pixels, by rounds of suppression, and more than options.min_score; the
/// best options.max_keypoints of them, best first. Each moves to the mean of the places around it, weighted by
/// exp(score / 0.1). No keypoint lies within two pixels of the border. `scores` [H, W] float32 on the CPU. Throws
/// ShapeError.
std::vector<Keypoint> FindKeypoints(const Tensor& scores, const KeypointOptions& options);

}  // namespace oraclegs::aliked
