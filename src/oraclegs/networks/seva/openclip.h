#pragma once
// Image half of OpenCLIP (docs/method.md#seva-image-encoder): turns an image into one vector that describes its
// content. The defaults are ViT-H-14 trained on laion2b_s32b_b79k.

#include <filesystem>
#include <vector>

#include "oraclegs/networks/common/layers.h"
#include "oraclegs/networks/common/tensor.h"

namespace oraclegs::seva {

/// images [B, 3, H, W] float32 RGB in [-1, 1], sides >= 2 -> [B, 3, side, side]: stretched, not cropped, then
/// normalized with CLIP's constants. An axis that shrinks is blurred first (BlurForResize); bicubic interpolation
/// (parameter -0.75) with aligned corners follows, not clamped. Throws ShapeError.
Tensor PrepareOpenClipInput(const Tensor& images, int64_t side = 224);

/// Gaussian weights for one axis, with sigma = max((factor - 1) / 2, 0.001) pixels and factor = length / side: an odd
/// number of them, at least 3, about 4 sigma wide, with sum 1.
std::vector<double> ResizeBlurWeights(int64_t length, int64_t side);

/// Blurs both axes, horizontal first, the image mirrored at its border without repeating the last pixel. Returns x [B,
/// C, H, W] itself when no axis shrinks.
Tensor BlurForResize(const Tensor& x, int64_t side);

struct OpenClipConfig {
  int64_t width = 1280, depth = 32, heads = 16;
  int64_t hidden = 5120;     ///< hidden width of the blocks' two linear layers
  int64_t patch = 14;        ///< side of a patch in pixels
  int64_t image_side = 224;  ///< side of the network's input, pixels
  int64_t output = 1024;     ///< length of an embedding
  double norm_eps = 1e-5;

  int64_t tokens() const { return 1 + (image_side / patch) * (image_side / patch); }
};

/// A pre-norm block without LayerScale, under OpenCLIP's names.
struct OpenClipBlock {
  int64_t heads = 0;
  LayerNorm norm1, norm2;
  Linear qkv, proj;
  Mlp mlp;
};

struct OpenClip {
  OpenClipConfig config;
  Conv patches;
  Tensor class_token;  ///< [width]
  Tensor positions;    ///< [tokens, width]
  LayerNorm norm_pre, norm_post;
  std::vector<OpenClipBlock> blocks;
  Tensor projection;  ///< [width, output]
};
/// `at` is the scope in which conv1.weight, ln_pre.weight, ... are: "visual" of a checkpoint. Throws ShapeError when
/// the heads do not divide the width or the patch does not divide the image.
OpenClip LoadOpenClip(const ParameterScope& at, const OpenClipConfig& config);
/// Reads a safetensors file of the whole model; only names that begin with `visual.` are read, never the text half.
/// Throws InputError that lists all that does not fit.
OpenClip LoadOpenClip(const std::filesystem::path& path, const OpenClipConfig& config = {},
                      torch::Device device = torch::kCPU, torch::ScalarType type = torch::kFloat);

/// Tokens that enter the first block: [B, tokens, width], class token first, then patches row by row. prepared [B, 3,
/// image_side, image_side] as from PrepareOpenClipInput (ShapeError otherwise).
Tensor EmbedPatches(const OpenClip& clip, const Tensor& prepared);

/// Addend of a block's attention to x [B, tokens, width].
Tensor AttentionUpdate(const OpenClipBlock& block, const Tensor& x);
/// Whole block: x [B, tokens, width] -> [B, tokens, width].
Tensor Forward(const OpenClipBlock& block, const Tensor& x);

/// prepared [B, 3, image_side, image_side] -> [B, output] float32, not of unit length.
Tensor Forward(const OpenClip& clip, const Tensor& prepared);

/// images [B, 3, H, W] float32 RGB in [-1, 1] of any size -> [B, output] float32, not of unit length, on the device of
/// the weights. One image at a time. Throws ShapeError.
Tensor ImageEmbeddings(const OpenClip& clip, const Tensor& images);

}  // namespace oraclegs::seva
