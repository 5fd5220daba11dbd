#pragma once
// The convolutional part of VGG16 and AlexNet up to five taps, forward and backward (docs/method.md#lpips).

#include <array>
#include <vector>

#include "oraclegs/networks/common/layers.h"

namespace oraclegs {

enum class FeatureNetwork { kVgg16, kAlexNet };

struct FeatureStackConfig {
  FeatureNetwork network = FeatureNetwork::kVgg16;
  std::array<int64_t, 5> channels = {64, 128, 256, 512, 512};  ///< at the taps
};
/// As published: VGG16 64, 128, 256, 512, 512; AlexNet 64, 192, 384, 256, 256.
FeatureStackConfig PublishedFeatures(FeatureNetwork network);

/// A convolution with its ReLU, perhaps behind a max-pool.
struct FeatureLayer {
  Conv conv;
  bool pool_before = false;
  bool tap_after = false;
};

struct FeatureStack {
  FeatureStackConfig config;
  std::vector<FeatureLayer> layers;
  int64_t pool_kernel = 2, pool_stride = 2;
  int64_t smallest_side = 16;  ///< of an input, in pixels
};
/// Names as torchvision has them: features.N.
FeatureStack LoadFeatureStack(const ParameterScope& at, const FeatureStackConfig& config);

/// What the backward pass needs of a forward pass.
struct FeatureTrace {
  std::vector<Tensor> inputs, outputs;  ///< of each convolution; outputs are rectified
  std::vector<Tensor> pool_indices;     ///< of the pool before each convolution, or undefined
};

/// The five taps of x [B, 3, H, W], [B, C, ...] each. `trace` null: nothing is kept. Throws ShapeError.
std::array<Tensor, 5> Features(const FeatureStack& stack, const Tensor& x, FeatureTrace* trace = nullptr);
/// dL/dx from dL/d(tap) of the five taps.
Tensor FeaturesBackward(const FeatureStack& stack, const FeatureTrace& trace, const std::array<Tensor, 5>& grad_taps);

}  // namespace oraclegs
