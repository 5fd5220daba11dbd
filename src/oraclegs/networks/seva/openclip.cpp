#include "oraclegs/networks/seva/openclip.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "oraclegs/networks/common/attention.h"
#include "oraclegs/networks/common/layers.h"

namespace oraclegs::seva {
namespace {

/// Sums shifted copies: libtorch's convolution may split its sum by the number of threads.
Tensor BlurAxis(const Tensor& x, int64_t axis, const std::vector<double>& weights) {
  const int64_t reach = static_cast<int64_t>(weights.size()) / 2, length = x.size(axis);
  const std::vector<int64_t> border =
      axis == 3 ? std::vector<int64_t>{reach, reach, 0, 0} : std::vector<int64_t>{0, 0, reach, reach};
  const Tensor padded = at::reflection_pad2d(x, border);
  Tensor sum = padded.narrow(axis, 0, length) * weights[0];
  for (size_t i = 1; i < weights.size(); ++i) {
    sum.add_(padded.narrow(axis, static_cast<int64_t>(i), length), weights[i]);
  }
  return sum;
}

OpenClipBlock LoadOpenClipBlock(const ParameterScope& at, const OpenClipConfig& config) {
  const int64_t width = config.width;
  const ParameterScope attention = at / "attn", mlp = at / "mlp";
  OpenClipBlock block;
  block.heads = config.heads;
  block.norm1 = LoadLayerNorm(at / "ln_1", width, config.norm_eps);
  block.qkv = {attention.Get("in_proj_weight", {3 * width, width}), attention.Get("in_proj_bias", {3 * width})};
  block.proj = LoadLinear(attention / "out_proj", width, width);
  block.norm2 = LoadLayerNorm(at / "ln_2", width, config.norm_eps);
  block.mlp = {LoadLinear(mlp / "c_fc", width, config.hidden), LoadLinear(mlp / "c_proj", config.hidden, width)};
  return block;
}

}  // namespace

std::vector<double> ResizeBlurWeights(int64_t length, int64_t side) {
  const double factor = static_cast<double>(length) / static_cast<double>(side);
  const double sigma = std::max((factor - 1) / 2, 0.001);
  int64_t taps = static_cast<int64_t>(std::max(4 * sigma, 3.0));
  if (taps % 2 == 0) ++taps;
  std::vector<double> weights;
  double sum = 0;
  for (int64_t i = 0; i < taps; ++i) {
    const double distance = static_cast<double>(i - taps / 2) / sigma;
    weights.push_back(std::exp(-distance * distance / 2));
    sum += weights.back();
  }
  for (double& weight : weights) weight /= sum;
  return weights;
}

Tensor BlurForResize(const Tensor& x, int64_t side) {
  const int64_t height = x.size(2), width = x.size(3);
  if (std::max(height, width) <= side) return x;
  return BlurAxis(BlurAxis(x, 3, ResizeBlurWeights(width, side)), 2, ResizeBlurWeights(height, side));
}

Tensor PrepareOpenClipInput(const Tensor& images, int64_t side) {
  RequireImages("PrepareOpenClipInput", images, 1);
  if (images.size(2) < 2 || images.size(3) < 2) {
    throw ShapeError("PrepareOpenClipInput: the images are {} x {}, expected 2 pixels a side at least", images.size(3),
                     images.size(2));
  }
  const Tensor resized = at::upsample_bicubic2d(BlurForResize(images, side).contiguous(), {side, side}, true);
  const auto constant = [&](float r, float g, float b) {
    return torch::tensor({r, g, b}).view({1, 3, 1, 1}).to(images.options());
  };
  const Tensor mean = constant(0.48145466f, 0.4578275f, 0.40821073f);
  const Tensor deviation = constant(0.26862954f, 0.26130258f, 0.27577711f);
  return ((resized + 1) / 2 - mean) / deviation;
}

OpenClip LoadOpenClip(const ParameterScope& at, const OpenClipConfig& config) {
  if (config.heads <= 0 || config.width % config.heads != 0) {
    throw ShapeError("LoadOpenClip: {} heads do not divide the width {}", config.heads, config.width);
  }
  if (config.patch <= 0 || config.image_side % config.patch != 0) {
    throw ShapeError("LoadOpenClip: patches of {} do not divide an image of {}", config.patch, config.image_side);
  }
  OpenClip clip;
  clip.config = config;
  clip.patches = LoadConv(at / "conv1", {3, config.width, config.patch, config.patch, 0, ConvBias::kNone});
  clip.class_token = at.Get("class_embedding", {config.width});
  clip.positions = at.Get("positional_embedding", {config.tokens(), config.width});
  clip.norm_pre = LoadLayerNorm(at / "ln_pre", config.width, config.norm_eps);
  for (int64_t i = 0; i < config.depth; ++i) {
    clip.blocks.push_back(LoadOpenClipBlock(at / "transformer" / "resblocks" / i, config));
  }
  clip.norm_post = LoadLayerNorm(at / "ln_post", config.width, config.norm_eps);
  clip.projection = at.Get("proj", {config.width, config.output});
  return clip;
}

OpenClip LoadOpenClip(const std::filesystem::path& path, const OpenClipConfig& config, torch::Device device,
                      torch::ScalarType type) {
  CheckpointOptions options;
  options.model = "the image encoder of OpenCLIP ViT-H-14";
  options.prefix = "visual.";
  options.device = device;
  options.cast_type = type;
  FileParameters source({path}, options);
  OpenClip clip = LoadOpenClip(ParameterScope(source), config);
  source.Finish();
  return clip;
}

Tensor EmbedPatches(const OpenClip& clip, const Tensor& prepared) {
  RequireImages("EmbedPatches", prepared, clip.config.image_side);
  const Tensor patches = Forward(clip.patches, prepared.to(clip.patches.weight.options())).flatten(2).transpose(1, 2);
  if (1 + patches.size(1) != clip.config.tokens()) {
    throw ShapeError("EmbedPatches: the images are {} x {}, expected {} a side", prepared.size(3), prepared.size(2),
                     clip.config.image_side);
  }
  const Tensor first = clip.class_token.expand({patches.size(0), 1, clip.config.width});
  return Forward(clip.norm_pre, at::cat({first, patches}, 1) + clip.positions);
}

Tensor AttentionUpdate(const OpenClipBlock& block, const Tensor& x) {
  const int64_t batch = x.size(0), tokens = x.size(1), width = x.size(2) / block.heads;
  const Tensor qkv =
      Forward(block.qkv, Forward(block.norm1, x)).view({batch, tokens, 3, block.heads, width}).permute({2, 0, 3, 1, 4});
  return Forward(block.proj, Attend(qkv[0], qkv[1], qkv[2]).transpose(1, 2).reshape(x.sizes()));
}

Tensor Forward(const OpenClipBlock& block, const Tensor& x) {
  Tensor y = AttentionUpdate(block, x).add_(x);
  return y.add_(Forward(block.mlp, Forward(block.norm2, y)));
}

Tensor Forward(const OpenClip& clip, const Tensor& prepared) {
  Tensor x = EmbedPatches(clip, prepared);
  for (const OpenClipBlock& block : clip.blocks) x = Forward(block, x);
  return at::matmul(Forward(clip.norm_post, x.select(1, 0)), clip.projection).to(torch::kFloat);
}

Tensor ImageEmbeddings(const OpenClip& clip, const Tensor& images) {
  RequireImages("ImageEmbeddings", images, 1);
  std::vector<Tensor> embeddings;
  for (int64_t i = 0; i < images.size(0); ++i) {
    embeddings.push_back(Forward(clip, PrepareOpenClipInput(images.slice(0, i, i + 1), clip.config.image_side)));
  }
  return at::cat(embeddings);
}

}  // namespace oraclegs::seva
