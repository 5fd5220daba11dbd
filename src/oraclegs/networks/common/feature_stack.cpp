#include "oraclegs/networks/common/feature_stack.h"

namespace oraclegs {
namespace {

void LoadVgg16(const ParameterScope& features, FeatureStack& stack) {
  constexpr std::array<int, 5> kConvs = {2, 2, 3, 3, 3};  // between pools
  int64_t index = 0, in = 3;
  for (size_t stage = 0; stage < 5; ++stage) {
    const int64_t out = stack.config.channels[stage];
    for (int i = 0; i < kConvs[stage]; ++i) {
      FeatureLayer layer{LoadConv(features / index, {in, out}), stage > 0 && i == 0, i + 1 == kConvs[stage]};
      stack.layers.push_back(std::move(layer));
      in = out;
      index += 2;  // a ReLU follows each
    }
    index += 1;  // the pool
  }
}

void LoadAlexNet(const ParameterScope& features, FeatureStack& stack) {
  const auto& c = stack.config.channels;
  stack.layers = {{LoadConv(features / 0, {3, c[0], 11, 4, 2}), false, true},
                  {LoadConv(features / 3, {c[0], c[1], 5, 1, 2}), true, true},
                  {LoadConv(features / 6, {c[1], c[2]}), true, true},
                  {LoadConv(features / 8, {c[2], c[3]}), false, true},
                  {LoadConv(features / 10, {c[3], c[4]}), false, true}};
  stack.pool_kernel = 3;
  stack.smallest_side = 31;
}

}  // namespace

FeatureStackConfig PublishedFeatures(FeatureNetwork network) {
  if (network == FeatureNetwork::kAlexNet) return {network, {64, 192, 384, 256, 256}};
  return {network, {64, 128, 256, 512, 512}};
}

FeatureStack LoadFeatureStack(const ParameterScope& at, const FeatureStackConfig& config) {
  FeatureStack stack;
  stack.config = config;
  if (config.network == FeatureNetwork::kAlexNet) {
    LoadAlexNet(at / "features", stack);
  } else {
    LoadVgg16(at / "features", stack);
  }
  return stack;
}

std::array<Tensor, 5> Features(const FeatureStack& stack, const Tensor& x, FeatureTrace* trace) {
  if (x.dim() != 4 || x.size(1) != 3 || x.size(2) < stack.smallest_side || x.size(3) < stack.smallest_side) {
    throw ShapeError("Features: the input is [{}], expected [any, 3, H, W] of at least {} pixels a side",
                     fmt::join(x.sizes(), ", "), stack.smallest_side);
  }
  std::array<Tensor, 5> taps;
  size_t tap = 0;
  Tensor y = x;
  for (const FeatureLayer& layer : stack.layers) {
    Tensor indices;
    if (layer.pool_before) std::tie(y, indices) = at::max_pool2d_with_indices(y, stack.pool_kernel, stack.pool_stride);
    if (trace) trace->inputs.push_back(y);
    if (trace) trace->pool_indices.push_back(indices);
    y = Forward(layer.conv, y);
    at::relu_(y);
    if (trace) trace->outputs.push_back(y);
    if (layer.tap_after) taps[tap++] = y;
  }
  return taps;
}

Tensor FeaturesBackward(const FeatureStack& stack, const FeatureTrace& trace, const std::array<Tensor, 5>& grad_taps) {
  Tensor grad;
  size_t tap = grad_taps.size();
  for (size_t i = stack.layers.size(); i-- > 0;) {
    const FeatureLayer& layer = stack.layers[i];
    if (layer.tap_after) {
      --tap;
      grad = grad.defined() ? grad + grad_taps[tap] : grad_taps[tap];
    }
    grad = at::threshold_backward(grad, trace.outputs[i], 0);
    const Conv& conv = layer.conv;
    grad = std::get<0>(at::convolution_backward(grad, trace.inputs[i], conv.weight, at::OptionalIntArrayRef(),
                                                {conv.stride, conv.stride}, {conv.padding, conv.padding}, {1, 1}, false,
                                                {0, 0}, 1, {true, false, false}));
    if (layer.pool_before) {
      grad = at::max_pool2d_with_indices_backward(grad, trace.outputs[i - 1], stack.pool_kernel, stack.pool_stride, 0,
                                                  1, false, trace.pool_indices[i]);
    }
  }
  return grad;
}

}  // namespace oraclegs
