#include "oraclegs/networks/common/transformer_block.h"

#include <vector>

#include "oraclegs/networks/common/attention.h"

namespace oraclegs {

RopeTable MakeRopeTable(const RopeGrid& grid, int64_t width, double base) {
  if (width <= 0 || width % 4 != 0) throw ShapeError("MakeRopeTable: a head is {} wide, no multiple of 4", width);
  const int64_t tokens = grid.special + grid.rows * grid.cols;
  std::vector<float> positions(static_cast<size_t>(2 * tokens), 0.f);
  for (int64_t r = 0; r < grid.rows; ++r) {
    for (int64_t c = 0; c < grid.cols; ++c) {
      const size_t token = static_cast<size_t>(grid.special + r * grid.cols + c);
      positions[2 * token] = static_cast<float>(r + 1);
      positions[2 * token + 1] = static_cast<float>(c + 1);
    }
  }
  const int64_t half = width / 2;
  const Tensor exponents = torch::arange(0, half, 2, torch::kFloat) / static_cast<double>(half);
  const Tensor frequencies = at::pow(torch::scalar_tensor(base, torch::kFloat), exponents).reciprocal();
  const Tensor angles = torch::tensor(positions).view({tokens, 2, 1, 1}) * frequencies;
  return {angles.cos(), angles.sin()};
}

RopeTable Repeat(const RopeTable& table, int64_t views) {
  return {table.cos.repeat({views, 1, 1, 1}), table.sin.repeat({views, 1, 1, 1})};
}

Tensor Rotate(const RopeTable& table, const Tensor& t) {
  const int64_t quarter = t.size(3) / 4;
  // [B, heads, tokens, axis, first or second of the pair, frequency]
  const Tensor pairs = t.reshape({t.size(0), t.size(1), t.size(2), 2, 2, quarter});
  const Tensor first = pairs.slice(4, 0, 1), second = pairs.slice(4, 1, 2);
  const Tensor cos = table.cos.to(t.options()), sin = table.sin.to(t.options());
  return at::cat({first * cos - second * sin, second * cos + first * sin}, 4).reshape(t.sizes());
}

Block LoadBlock(const ParameterScope& at, const BlockConfig& config) {
  const int64_t width = config.width;
  if (config.heads <= 0 || width % config.heads != 0) {
    throw ShapeError("LoadBlock: {} heads do not divide the width {}", config.heads, width);
  }
  Block block;
  block.heads = config.heads;
  block.norm1 = LoadLayerNorm(at / "norm1", width, config.norm_eps);
  block.qkv = LoadLinear(at / "attn" / "qkv", width, 3 * width);
  if (config.query_key_norm == QueryKeyNorm::kLayerNorm) {
    block.q_norm = LoadLayerNorm(at / "attn" / "q_norm", width / config.heads, config.norm_eps);
    block.k_norm = LoadLayerNorm(at / "attn" / "k_norm", width / config.heads, config.norm_eps);
  }
  block.proj = LoadLinear(at / "attn" / "proj", width, width);
  block.attention_scale = (at / "ls1").Get("gamma", {width});
  block.norm2 = LoadLayerNorm(at / "norm2", width, config.norm_eps);
  block.mlp = LoadMlp(at / "mlp", {width, config.mlp_ratio * width, width});
  block.mlp_scale = (at / "ls2").Get("gamma", {width});
  return block;
}

QueriesKeysValues AttentionInputs(const Block& block, const Tensor& x, const RopeTable* rope) {
  const int64_t batch = x.size(0), tokens = x.size(1), width = x.size(2) / block.heads;
  const Tensor qkv =
      Forward(block.qkv, Forward(block.norm1, x)).view({batch, tokens, 3, block.heads, width}).permute({2, 0, 3, 1, 4});
  QueriesKeysValues out{qkv[0], qkv[1], qkv[2]};
  if (block.q_norm) out.q = Forward(*block.q_norm, out.q);
  if (block.k_norm) out.k = Forward(*block.k_norm, out.k);
  if (rope) out.q = Rotate(*rope, out.q);
  if (rope) out.k = Rotate(*rope, out.k);
  return out;
}

Tensor AfterAttention(const Block& block, const Tensor& x, const Tensor& attended) {
  const Tensor joined = Forward(block.proj, attended.transpose(1, 2).reshape(x.sizes()));
  const Tensor y = at::addcmul(x, joined, block.attention_scale);
  return at::addcmul(y, Forward(block.mlp, Forward(block.norm2, y)), block.mlp_scale);
}

Tensor Forward(const Block& block, const Tensor& x, const RopeTable* rope) {
  Tensor attended;
  {
    const QueriesKeysValues in = AttentionInputs(block, x, rope);  // freed before the wide layer is made
    attended = Attend(in.q, in.k, in.v);
  }
  return AfterAttention(block, x, attended);
}

}  // namespace oraclegs
