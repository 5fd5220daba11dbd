#include "oraclegs/networks/common/vit.h"

#include <algorithm>

namespace oraclegs {

Vit LoadVit(const ParameterScope& at, const VitConfig& config) {
  Vit vit;
  vit.config = config;
  vit.class_token = at.Get("cls_token", {1, 1, config.width});
  vit.positions = at.Get("pos_embed", {1, 1 + config.position_grid * config.position_grid, config.width});
  if (config.registers > 0) vit.register_tokens = at.Get("register_tokens", {1, config.registers, config.width});
  at.Unused("mask_token", {1, config.width});  // only training masks patches
  vit.patches = LoadConv(at / "patch_embed" / "proj", {3, config.width, config.patch, config.patch, 0});
  for (int64_t i = 0; i < config.depth; ++i) {
    vit.blocks.push_back(LoadBlock(at / "blocks" / i, {config.width, config.heads, config.mlp_ratio, config.norm_eps}));
  }
  vit.norm = LoadLayerNorm(at / "norm", config.width, config.norm_eps);
  return vit;
}

Tensor PositionEmbedding(const Vit& vit, int64_t rows, int64_t cols) {
  const VitConfig& config = vit.config;
  const int64_t side = config.position_grid;
  const Tensor stored = vit.positions.to(torch::kFloat);
  if (rows == side && cols == side) return stored;
  const Tensor grid = stored.slice(1, 1).reshape({1, side, side, config.width}).permute({0, 3, 1, 2}).contiguous();
  const auto resample = [&](auto... scales) {
    return config.position_antialias ? at::_upsample_bicubic2d_aa(grid, {rows, cols}, false, scales...)
                                     : at::upsample_bicubic2d(grid, {rows, cols}, false, scales...);
  };
  const double scale_y = (static_cast<double>(rows) + config.position_offset) / static_cast<double>(side);
  const double scale_x = (static_cast<double>(cols) + config.position_offset) / static_cast<double>(side);
  const Tensor resampled = config.position_offset != 0 ? resample(scale_y, scale_x) : resample();
  return at::cat({stored.slice(1, 0, 1), resampled.flatten(2).transpose(1, 2)}, 1);
}

Tensor EmbedImages(const Vit& vit, const Tensor& images) {
  RequireImages("EmbedImages", images, vit.config.patch);
  const int64_t batch = images.size(0), width = vit.config.width;
  const int64_t rows = images.size(2) / vit.config.patch, cols = images.size(3) / vit.config.patch;
  const Tensor patches = Forward(vit.patches, images.to(vit.patches.weight.options())).flatten(2).transpose(1, 2);
  const Tensor positions = PositionEmbedding(vit, rows, cols).to(patches.scalar_type());
  const Tensor tokens = at::cat({vit.class_token.expand({batch, 1, width}), patches}, 1) + positions;
  if (vit.config.registers == 0) return tokens;
  const Tensor registers = vit.register_tokens.expand({batch, vit.config.registers, width});
  return at::cat({tokens.slice(1, 0, 1), registers, tokens.slice(1, 1)}, 1);
}

std::vector<Tensor> LayerTokens(const Vit& vit, const Tensor& images, const std::vector<int64_t>& layers) {
  const bool fits = !layers.empty() && layers.front() >= 0 && layers.back() < vit.config.depth &&
                    std::is_sorted(layers.begin(), layers.end());
  if (!fits) {
    throw ShapeError("LayerTokens: layers {} of a network of {}, expected ascending", fmt::join(layers, ", "),
                     vit.config.depth);
  }
  Tensor x = EmbedImages(vit, images);
  std::vector<Tensor> out;
  for (int64_t i = 0; i <= layers.back(); ++i) {
    x = Forward(vit.blocks[static_cast<size_t>(i)], x);
    const auto wanted = std::count(layers.begin(), layers.end(), i);
    if (wanted > 0) out.insert(out.end(), static_cast<size_t>(wanted), Forward(vit.norm, x));
  }
  return out;
}

}  // namespace oraclegs
