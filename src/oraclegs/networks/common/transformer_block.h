#pragma once
// The pre-norm transformer block with LayerScale that DINOv2, VGGT and its camera head are made of
// (docs/method.md#transformer-block), and its rotary position embedding over two axes (#rotary-positions).

#include <optional>

#include "oraclegs/networks/common/layers.h"
#include "oraclegs/networks/common/tensor.h"

namespace oraclegs {

/// Cosines and sines for each token of a sequence: [tokens, 2 (y, x), 1, width / 4].
struct RopeTable {
  Tensor cos, sin;
};

/// Layout of one view's tokens, from which their positions follow.
struct RopeGrid {
  int64_t special = 0;         ///< tokens in front, at position (0, 0): not rotated
  int64_t rows = 0, cols = 0;  ///< grid of patches, row-major; patch (r, c) is at (r + 1, c + 1)
};

/// `width` is that of a head, a multiple of 4 (ShapeError otherwise); frequencies are base^(-4 j / width).
RopeTable MakeRopeTable(const RopeGrid& grid, int64_t width, double base);
/// Tables of `views` views, one after the other.
RopeTable Repeat(const RopeTable& table, int64_t views);
/// t [B, heads, tokens, width]: the first half of each vector is rotated by y, the second by x; entry j of a half pairs
/// with entry j + width / 4.
Tensor Rotate(const RopeTable& table, const Tensor& t);

enum class QueryKeyNorm { kNone, kLayerNorm };

struct BlockConfig {
  int64_t width = 0, heads = 0;
  int64_t mlp_ratio = 4;
  double norm_eps = 1e-5;  ///< also for the norms of queries and keys
  QueryKeyNorm query_key_norm = QueryKeyNorm::kNone;
};

struct Block {
  int64_t heads = 0;
  LayerNorm norm1, norm2;
  Linear qkv, proj;
  std::optional<LayerNorm> q_norm, k_norm;
  Tensor attention_scale, mlp_scale;  ///< LayerScale, [width]
  Mlp mlp;
};
/// Throws ShapeError when the heads do not divide the width.
Block LoadBlock(const ParameterScope& at, const BlockConfig& config);

/// [B, heads, N, width / heads] each; queries and keys after norm and rotation.
struct QueriesKeysValues {
  Tensor q, k, v;
};

/// Inputs of a block's attention; x [B, N, width], rope null for none.
QueriesKeysValues AttentionInputs(const Block& block, const Tensor& x, const RopeTable* rope);
/// Second half of a block: x and the attended values [B, heads, N, width / heads] -> [B, N, width].
Tensor AfterAttention(const Block& block, const Tensor& x, const Tensor& attended);
/// Whole block: x [B, N, width] -> [B, N, width].
Tensor Forward(const Block& block, const Tensor& x, const RopeTable* rope = nullptr);

}  // namespace oraclegs
