#pragma once
// The DINOv2 vision transformer, with and without register tokens (docs/method.md#vision-transformer).

#include <vector>

#include "oraclegs/networks/common/transformer_block.h"

namespace oraclegs {

struct VitConfig {
  int64_t width = 384, depth = 12, heads = 6;
  int64_t mlp_ratio = 4;
  int64_t patch = 14;          ///< side of a patch in pixels
  int64_t position_grid = 37;  ///< side of the square of stored position embeddings
  int64_t registers = 0;
  double norm_eps = 1e-6;
  /// Resampling of positions to another grid of patches: a `position_offset` o > 0 scales by the factors (rows + o) /
  /// position_grid; 0 resizes to the target size.
  double position_offset = 0.1;
  bool position_antialias = false;
};

struct Vit {
  VitConfig config;
  Conv patches;
  Tensor class_token;      ///< [1, 1, width]
  Tensor register_tokens;  ///< [1, registers, width], or undefined
  Tensor positions;        ///< [1, 1 + position_grid^2, width]
  std::vector<Block> blocks;
  LayerNorm norm;

  int64_t special_tokens() const { return 1 + config.registers; }
};
Vit LoadVit(const ParameterScope& at, const VitConfig& config);

/// Position embeddings [1, 1 + rows * cols, width] float32: row 0 for the class token, then the grid, row-major.
Tensor PositionEmbedding(const Vit& vit, int64_t rows, int64_t cols);

/// Tokens that enter the first block: [B, 1 + registers + patches, width], in the order class, registers, patches.
/// images [B, 3, H, W] float32, normalized, sides multiples of the patch (ShapeError otherwise).
Tensor EmbedImages(const Vit& vit, const Tensor& images);

/// Tokens after each of `layers` (0-based, ascending), each through the final norm: [B, 1 + registers + patches,
/// width]. Blocks behind the last one are not computed. Throws ShapeError.
std::vector<Tensor> LayerTokens(const Vit& vit, const Tensor& images, const std::vector<int64_t>& layers);

}  // namespace oraclegs
