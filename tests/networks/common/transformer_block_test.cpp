#include "oraclegs/networks/common/transformer_block.h"

#include "networks/golden_tensors.h"
#include "oraclegs/networks/common/attention.h"

namespace oraclegs {
namespace {

Block RandomBlock(const BlockConfig& config) {
  RandomParameters source(3);
  return LoadBlock(ParameterScope(source) / "block", config);
}

TEST(TransformerBlock, WithoutScaleItIsTheIdentity) {
  Block block = RandomBlock({8, 2});
  block.attention_scale = torch::zeros({8});
  block.mlp_scale = torch::zeros({8});
  const Tensor x = torch::rand({2, 5, 8});
  EXPECT_TRUE(torch::equal(Forward(block, x), x));
}

TEST(TransformerBlock, IsItsDefinition) {
  torch::manual_seed(7);
  const Block block = RandomBlock({8, 2, 4, 1e-5, QueryKeyNorm::kLayerNorm});
  const Tensor x = torch::randn({1, 6, 8});
  const RopeTable rope = MakeRopeTable({2, 2, 2}, 4, 100);
  const Tensor qkv = Forward(block.qkv, Forward(block.norm1, x))[0];
  std::vector<Tensor> heads;
  for (int64_t h = 0; h < 2; ++h) {
    const auto part = [&](int64_t which) { return qkv.slice(1, 8 * which + 4 * h, 8 * which + 4 * h + 4); };
    const Tensor q = Rotate(rope, Forward(*block.q_norm, part(0)).view({1, 1, 6, 4}))[0][0];
    const Tensor k = Rotate(rope, Forward(*block.k_norm, part(1)).view({1, 1, 6, 4}))[0][0];
    heads.push_back(at::matmul(at::softmax(at::matmul(q, k.t()) / 2, -1), part(2)));
  }
  Tensor y = x + block.attention_scale * Forward(block.proj, at::cat(heads, 1)).unsqueeze(0);
  y = y + block.mlp_scale * Forward(block.mlp, Forward(block.norm2, y));
  EXPECT_LT(MaxAbsError(Forward(block, x, &rope), y), 1e-6);
}

TEST(TransformerBlock, TokensOfDifferentSequencesDoNotMeet) {
  const Block block = RandomBlock({8, 2});
  const Tensor x = torch::rand({2, 5, 8});
  Tensor changed = x.clone();
  changed[1].fill_(3);
  EXPECT_LT(MaxAbsError(Forward(block, x)[0], Forward(block, changed)[0]), 1e-6);
}

TEST(TransformerBlock, HeadsMustDivideTheWidth) {
  EXPECT_THROW(RandomBlock({8, 3}), ShapeError);
  EXPECT_THROW(RandomBlock({8, 0}), ShapeError);
}

}  // namespace
}  // namespace oraclegs
