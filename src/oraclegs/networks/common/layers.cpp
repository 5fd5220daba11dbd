#include "oraclegs/networks/common/layers.h"

namespace oraclegs {
namespace {

/// A 1x1 convolution as a matrix product: oneDNN's splits its sum over the channels by the number of threads, so that
/// the last bits would depend on it.
Tensor Pointwise(const Conv& layer, const Tensor& x) {
  if (layer.channels_last) {
    return at::linear(x.permute({0, 2, 3, 1}), layer.weight.flatten(1), layer.bias).permute({0, 3, 1, 2});
  }
  const int64_t batch = x.size(0), out = layer.weight.size(0);
  const Tensor weight = layer.weight.flatten(1).expand({batch, -1, -1}), pixels = x.flatten(2);
  const Tensor y =
      layer.bias.defined() ? at::baddbmm(layer.bias.view({1, out, 1}), weight, pixels) : at::bmm(weight, pixels);
  return y.view({batch, out, x.size(2), x.size(3)});
}

}  // namespace

Linear LoadLinear(const ParameterScope& at, int64_t in, int64_t out) {
  return {at.Get("weight", {out, in}), at.Get("bias", {out})};
}

Tensor Forward(const Linear& layer, const Tensor& x) { return at::linear(x, layer.weight, layer.bias); }

LayerNorm LoadLayerNorm(const ParameterScope& at, int64_t width, double eps) {
  return {at.Get("weight", {width}), at.Get("bias", {width}), eps};
}

Tensor Forward(const LayerNorm& layer, const Tensor& x) {
  const bool mixed = x.scalar_type() != layer.weight.scalar_type();  // within Autocast: then the norm is float32
  return at::layer_norm(mixed ? x.to(layer.weight.scalar_type()) : x, {x.size(-1)}, layer.weight, layer.bias,
                        layer.eps);
}

Conv LoadConv(const ParameterScope& at, const ConvShape& shape) {
  Conv conv{at.Get("weight", {shape.out, shape.in, shape.kernel, shape.kernel}), {}, shape.stride, shape.padding};
  if (shape.bias == ConvBias::kLearned) conv.bias = at.Get("bias", {shape.out});
  return conv;
}

Tensor Forward(const Conv& layer, const Tensor& x) {
  const bool pointwise = layer.weight.size(2) == 1 && layer.stride == 1 && layer.padding == 0;
  if (pointwise) return Pointwise(layer, x);
  return at::conv2d(x, layer.weight, layer.bias, layer.stride, layer.padding);
}

Upconv LoadUpconv(const ParameterScope& at, int64_t channels, int64_t kernel) {
  return {at.Get("weight", {channels, channels, kernel, kernel}), at.Get("bias", {channels})};
}

Tensor Forward(const Upconv& layer, const Tensor& x) {
  return at::conv_transpose2d(x, layer.weight, layer.bias, layer.weight.size(2));
}

Mlp LoadMlp(const ParameterScope& at, const MlpShape& shape) {
  return {LoadLinear(at / "fc1", shape.in, shape.hidden), LoadLinear(at / "fc2", shape.hidden, shape.out)};
}

Tensor Forward(const Mlp& layer, const Tensor& x) {
  Tensor hidden = Forward(layer.fc1, x);
  at::gelu_(hidden);  // the widest activation of a block: no second copy of it
  return Forward(layer.fc2, hidden);
}

Tensor ResizeBilinear(const Tensor& x, int64_t height, int64_t width, Corners corners) {
  return at::upsample_bilinear2d(x, {height, width}, corners == Corners::kAligned);
}

Tensor NormalizeRgb(const Tensor& x) {
  const Tensor mean = torch::tensor({0.485f, 0.456f, 0.406f}).view({1, 3, 1, 1}).to(x.options());
  const Tensor deviation = torch::tensor({0.229f, 0.224f, 0.225f}).view({1, 3, 1, 1}).to(x.options());
  return (x - mean) / deviation;
}

void RequireImages(const char* who, const Tensor& images, int64_t patch) {
  const bool ok = images.defined() && images.dim() == 4 && images.scalar_type() == torch::kFloat &&
                  images.size(0) > 0 && images.size(1) == 3 && images.size(2) > 0 && images.size(3) > 0 &&
                  images.size(2) % patch == 0 && images.size(3) % patch == 0;
  if (ok) return;
  if (!images.defined()) throw ShapeError("{}: the images are undefined", who);
  throw ShapeError("{}: the images are [{}] {}, expected float32 [any, 3, H, W] with H and W multiples of {}", who,
                   fmt::join(images.sizes(), ", "), c10::toString(images.scalar_type()), patch);
}

}  // namespace oraclegs
