#pragma once
// Descriptors of keypoints: features at places around each that the network chooses, weighted and added [Zhao 2023].

#include <vector>

#include "oraclegs/networks/aliked/encoder.h"
#include "oraclegs/networks/aliked/keypoints.h"

namespace oraclegs::aliked {

struct DescriptorHead {
  AlikedConfig config;
  Conv offsets;           ///< 3x3 around a keypoint -> 2 samples
  Linear offsets2;        ///< then all x of the samples, and all y
  Tensor feature_weight;  ///< [size, size], of each sample's features
  Tensor sample_weights;  ///< [samples * size, size]
};
DescriptorHead LoadDescriptorHead(const ParameterScope& at, const AlikedConfig& config);

/// Descriptors [keypoints, size] of unit length, made on the CPU wherever the maps are. Their bits do not depend on the
/// number of threads.
Tensor Describe(const DescriptorHead& head, const FeatureMaps& maps, const std::vector<Keypoint>& keypoints);

}  // namespace oraclegs::aliked
