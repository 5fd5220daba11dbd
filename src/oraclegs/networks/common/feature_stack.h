#pragma once
// The convolutional part of VGG16 and AlexNet up to five taps, forward and backward (docs/method.md#lpips).

#include <array>
#include <vector>

#include "oraclegs/networks/common/layers.h"

namespace oraclegs {

enum class FeatureNetwork { kVgg16, kAlexNet };

struct FeatureStackConfig {
  FeatureNetwork network = FeatureNetwork::kVgg16;
  std::array<int64_t, 5> channels = {64, 128, 256, 512, 512};  ///< channels at each tap
};
/// Published widths: VGG16 64, 128, 256, 512, 512; AlexNet 64, 192, 384, 256, 256.
FeatureStackConfig PublishedFeatures(FeatureNetwork network);

/// A convolution with its ReLU; a max-pool may come before it.
struct FeatureLayer {
  Conv conv;
  bool pool_before = false;
  bool tap_after = false;
};

struct FeatureStack {
  FeatureStackConfig config;
  std::vector<FeatureLayer> layers;
  int64_t pool_kernel = 2, pool_stride = 2;
  int64_t smallest_side = 16;  ///< shorter side that an input must have, pixels
};
/// Tensor names are torchvision's: features.N.
FeatureStack LoadFeatureStack(const ParameterScope& at, const FeatureStackConfig& config);

/// Activations of a forward pass that the backward pass needs.
struct FeatureTrace {
  std::vector<Tensor> inputs, outputs;  ///< one entry a convolution; outputs are rectified
  std::vector<Tensor> pool_indices;     ///< one entry a convolution: indices of the pool before it, or undefined
};

/// Five taps of x [B, 3, H, W], each [B, C, ...]. A null `trace` keeps nothing. Throws ShapeError.
std::array<Tensor, 5> Features(const FeatureStack& stack, const Tensor& x, FeatureTrace* trace = nullptr);
/// dL/dx from dL/d(tap) of the five taps.
Tensor FeaturesBackward(const FeatureStack& stack, const FeatureTrace& trace, const std::array<Tensor, 5>& grad_taps);

}  // namespace oraclegs
