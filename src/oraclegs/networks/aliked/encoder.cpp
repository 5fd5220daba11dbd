#include "oraclegs/networks/aliked/encoder.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace oraclegs::aliked {
namespace {

constexpr double kNormEps = 1e-5;
constexpr int64_t kTaps = 9;
constexpr std::array<int64_t, 3> kPools = {2, 4, 4};  // before the second, third and fourth block

/// A convolution without bias and the batch norm behind it, as one convolution with bias.
Conv LoadNormed(const ParameterScope& at, const ParameterScope& norm, const ConvShape& shape) {
  Conv conv = LoadConv(at, shape);
  const Tensor weight = norm.Get("weight", {shape.out}), bias = norm.Get("bias", {shape.out});
  const Tensor mean = norm.Get("running_mean", {shape.out}), variance = norm.Get("running_var", {shape.out});
  for (const Tensor& part : {conv.weight, weight, bias, mean, variance}) {
    if (part.is_meta()) return conv;  // missing, or only listed: there are no numbers to multiply
  }
  const Tensor scale = weight / (variance + kNormEps).sqrt();
  conv.weight = conv.weight * scale.view({shape.out, 1, 1, 1});
  conv.bias = bias - mean * scale;
  return conv;
}

enum class Taps { kFixed, kDeformable };

BlockConv LoadBlockConv(const ParameterScope& at, int64_t number, const ConvShape& shape, Taps taps) {
  const ParameterScope conv = at / ("conv" + std::to_string(number)), norm = at / ("bn" + std::to_string(number));
  if (taps == Taps::kFixed) return {LoadNormed(conv, norm, shape), {}};
  return {LoadNormed(conv / "regular_conv", norm, shape),
          LoadConv(conv / "offset_conv", ConvShape{.in = shape.in, .out = 2 * kTaps})};
}

Block LoadBlock(const ParameterScope& at, int64_t in, int64_t out, Taps taps) {
  const auto shape = [&](int64_t channels) { return ConvShape{.in = channels, .out = out, .bias = ConvBias::kNone}; };
  return {LoadBlockConv(at, 1, shape(in), taps), LoadBlockConv(at, 2, shape(out), taps), {}};
}

Conv LoadPointwise(const ParameterScope& at, int64_t in, int64_t out, ConvBias bias) {
  return LoadConv(at, {.in = in, .out = out, .kernel = 1, .padding = 0, .bias = bias});
}

Tensor Selu(Tensor x) { return at::selu_(x); }

Tensor Forward(const Block& block, const Tensor& x) {
  Tensor out = Forward(block.conv2, Selu(Forward(block.conv1, x)));
  if (block.shortcut.weight.defined()) out += oraclegs::Forward(block.shortcut, x);
  return Selu(out);
}

/// Pixels at the beginning and at the end of a side that bring it to a multiple of the largest stride.
std::array<int64_t, 2> Margins(int64_t side) {
  const int64_t margin = (kStrides[3] - side % kStrides[3]) % kStrides[3];
  return {margin / 2, margin - margin / 2};
}

/// Scores of all pixels of the largest map. The head's first layer, which is linear, is applied to each map before that
/// is enlarged: the same as to all maps enlarged, of which the largest would be eight times as large.
Tensor Scores(const Encoder& encoder, const std::array<Tensor, 4>& maps) {
  const int64_t height = maps[0].size(2), width = maps[0].size(3), channels = maps[0].size(1);
  Tensor sum;
  for (int64_t i = 0; i < 4; ++i) {
    Conv part = encoder.score_head[0];
    part.weight = part.weight.slice(1, i * channels, (i + 1) * channels).contiguous();
    Tensor own = oraclegs::Forward(part, maps[static_cast<size_t>(i)]);
    if (i > 0) own = ResizeBilinear(own, height, width, Corners::kAligned);
    sum = sum.defined() ? sum.add_(own) : own;
  }
  for (size_t i = 1; i < 4; ++i) sum = oraclegs::Forward(encoder.score_head[i], Selu(sum));
  return at::sigmoid(sum)[0][0];
}

}  // namespace

Tensor Forward(const BlockConv& layer, const Tensor& x) {
  if (!layer.offsets.weight.defined()) return oraclegs::Forward(layer.conv, x);
  const int64_t channels = x.size(1), height = x.size(2), width = x.size(3);
  const double reach = static_cast<double>(std::max(height, width)) / 4;
  const Tensor offsets = oraclegs::Forward(layer.offsets, x).clamp_(-reach, reach).view({kTaps, 2, height, width});
  const auto range = [&](int64_t begin, int64_t end) { return at::arange(begin, end, x.options()); };
  const Tensor around = range(-1, 2);
  const Tensor y =
      offsets.select(1, 0) + range(0, height).view({1, height, 1}) + around.repeat_interleave(3).view({kTaps, 1, 1});
  const Tensor left =
      offsets.select(1, 1) + range(0, width).view({1, 1, width}) + around.repeat({3}).view({kTaps, 1, 1});
  const auto normalized = [](const Tensor& pixel, int64_t side) {
    return (2 * pixel + 1) / static_cast<double>(side) - 1;
  };
  const Tensor places = at::stack({normalized(left, width), normalized(y, height)}, -1);
  const Tensor taps = at::grid_sampler(x, places.view({1, kTaps * height, width, 2}), /*interpolation_mode=*/0,
                                       /*padding_mode=*/0, /*align_corners=*/false);
  const Tensor columns = taps.view({1, channels * kTaps, height, width});
  const Conv product{layer.conv.weight.view({-1, channels * kTaps, 1, 1}), layer.conv.bias, 1, 0};
  return oraclegs::Forward(product, columns);
}

Encoder LoadEncoder(const ParameterScope& at, const AlikedConfig& config) {
  Encoder encoder;
  encoder.config = config;
  const int64_t size = config.descriptor_size(), quarter = size / 4;
  for (int64_t i = 0; i < 4; ++i) {
    const auto k = static_cast<size_t>(i);
    const std::string number = std::to_string(i + 1);
    const int64_t in = i == 0 ? 3 : config.widths[k - 1], out = config.widths[k];
    const ParameterScope block = at / ("block" + number);
    encoder.blocks[k] = LoadBlock(block, in, out, i < 2 ? Taps::kFixed : Taps::kDeformable);
    if (i > 0) encoder.blocks[k].shortcut = LoadPointwise(block / "downsample", in, out, ConvBias::kLearned);
    encoder.reductions[k] = LoadPointwise(at / ("conv" + number), out, quarter, ConvBias::kNone);
  }
  const ParameterScope head = at / "score_head";
  encoder.score_head = {LoadPointwise(head / 0, size, 8, ConvBias::kNone),
                        LoadConv(head / 2, {.in = 8, .out = 4, .bias = ConvBias::kNone}),
                        LoadConv(head / 4, {.in = 4, .out = 4, .bias = ConvBias::kNone}),
                        LoadConv(head / 6, {.in = 4, .out = 1, .bias = ConvBias::kNone})};
  return encoder;
}

FeatureMaps Forward(const Encoder& encoder, const Tensor& rgb) {
  RequireFloat("ALIKED", "rgb", rgb, {-1, -1, 3});
  const int64_t height = rgb.size(0), width = rgb.size(1);
  if (height < 1 || width < 1) throw ShapeError("ALIKED: the image has no pixel");
  const auto [left, right] = Margins(width);
  const auto [top, bottom] = Margins(height);
  Tensor x = at::replication_pad2d(rgb.permute({2, 0, 1}).unsqueeze(0).contiguous(), {left, right, top, bottom});
  FeatureMaps out;
  out.left = left, out.top = top;
  for (size_t i = 0; i < 4; ++i) {
    if (i > 0) x = at::avg_pool2d(x, kPools[i - 1]);
    x = Forward(encoder.blocks[i], x);
    out.maps[i] = Selu(oraclegs::Forward(encoder.reductions[i], x));
  }
  out.scores = Scores(encoder, out.maps).slice(0, top, top + height).slice(1, left, left + width).contiguous();
  return out;
}

}  // namespace oraclegs::aliked
