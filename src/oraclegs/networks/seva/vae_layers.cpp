#include "oraclegs/networks/seva/vae_layers.h"

#include "oraclegs/networks/common/attention.h"

namespace oraclegs::seva {

VaeResnet LoadVaeResnet(const ParameterScope& at, int64_t in, int64_t out, const VaeNormShape& norm) {
  VaeResnet block;
  block.norm1 = LoadGroupNorm(at / "norm1", in, norm.groups, norm.eps);
  block.conv1 = LoadConv(at / "conv1", {in, out});
  block.norm2 = LoadGroupNorm(at / "norm2", out, norm.groups, norm.eps);
  block.conv2 = LoadConv(at / "conv2", {out, out});
  if (in != out) block.shortcut = LoadConv(at / "conv_shortcut", {in, out, 1, 1, 0});
  return block;
}

Tensor Forward(const VaeResnet& block, const Tensor& x) {
  Tensor y = NormThenSilu(block.norm1, x);
  y = Forward(block.conv1, y);
  y = NormThenSilu(block.norm2, y);
  y = Forward(block.conv2, y);
  return y.add_(block.shortcut ? Forward(*block.shortcut, x) : x);
}

VaeAttention LoadVaeAttention(const ParameterScope& at, int64_t channels, const VaeNormShape& norm) {
  return {LoadGroupNorm(at / "group_norm", channels, norm.groups, norm.eps),
          LoadLinear(at / "to_q", channels, channels), LoadLinear(at / "to_k", channels, channels),
          LoadLinear(at / "to_v", channels, channels), LoadLinear(at / "to_out" / 0, channels, channels)};
}

Tensor Forward(const VaeAttention& attention, const Tensor& x) {
  const Tensor tokens = Forward(attention.norm, x).flatten(2).transpose(1, 2).contiguous();  // [B, h w, C]
  const auto one_head = [&](const Linear& layer) { return Forward(layer, tokens).unsqueeze(1); };
  const Tensor seen = Attend(one_head(attention.q), one_head(attention.k), one_head(attention.v)).squeeze(1);
  return x + Forward(attention.out, seen).transpose(1, 2).reshape(x.sizes());
}

VaeMiddle LoadVaeMiddle(const ParameterScope& at, int64_t channels, const VaeNormShape& norm) {
  return {LoadVaeResnet(at / "resnets" / 0, channels, channels, norm),
          LoadVaeAttention(at / "attentions" / 0, channels, norm),
          LoadVaeResnet(at / "resnets" / 1, channels, channels, norm)};
}

Tensor Forward(const VaeMiddle& middle, const Tensor& x) {
  return Forward(middle.last, Forward(middle.attention, Forward(middle.first, x)));
}

VaeLevel LoadVaeLevel(const ParameterScope& at, const VaeLevelShape& shape, const VaeNormShape& norm) {
  VaeLevel level;
  level.resample = shape.resample;
  for (int64_t i = 0; i < shape.resnets; ++i) {
    level.resnets.push_back(LoadVaeResnet(at / "resnets" / i, i == 0 ? shape.in : shape.out, shape.out, norm));
  }
  if (shape.resample == VaeResample::kHalve) {
    level.conv = LoadConv(at / "downsamplers" / 0 / "conv", {shape.out, shape.out, 3, 2, 0});
  } else if (shape.resample == VaeResample::kDouble) {
    level.conv = LoadConv(at / "upsamplers" / 0 / "conv", {shape.out, shape.out});
  }
  return level;
}

Tensor Forward(const VaeLevel& level, Tensor x) {
  for (const VaeResnet& resnet : level.resnets) x = Forward(resnet, x);
  if (level.resample == VaeResample::kHalve) x = at::constant_pad_nd(x, {0, 1, 0, 1});
  if (level.resample == VaeResample::kDouble) x = at::upsample_nearest2d(x, {2 * x.size(2), 2 * x.size(3)});
  return level.conv ? Forward(*level.conv, x) : x;
}

}  // namespace oraclegs::seva
