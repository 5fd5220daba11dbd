#include "oraclegs/networks/common/transformer_block.h"

#include <cmath>

#include "networks/golden_tensors.h"
#include "oraclegs/networks/common/attention.h"

namespace oraclegs {
namespace {

TEST(Rope, RotatesPairsByTheirFrequency) {
  // A width of 8: two frequencies for each axis, 1 and 1/10. The token of patch (1, 0) is at y = 2, x = 1.
  const RopeTable table = MakeRopeTable({1, 2, 1}, 8, 100);
  Tensor t = torch::zeros({1, 1, 3, 8});
  t[0][0][2][0] = 1;  // y, first of the pair, frequency 0
  t[0][0][2][7] = 1;  // x, second of the pair, frequency 1
  const Tensor r = Rotate(table, t)[0][0][2];
  const double y_angle = 2, x_angle = 0.1;
  const std::vector<double> expected = {std::cos(y_angle),  0, std::sin(y_angle), 0, 0,
                                        -std::sin(x_angle), 0, std::cos(x_angle)};
  EXPECT_LT(MaxAbsError(r, torch::tensor(expected, torch::kDouble)), 1e-6);
}

TEST(Rope, SpecialTokensStay) {
  const RopeTable table = MakeRopeTable({2, 1, 2}, 4, 100);
  const Tensor t = torch::rand({2, 3, 4, 4});
  const Tensor r = Rotate(table, t);
  EXPECT_TRUE(torch::equal(r.slice(2, 0, 2), t.slice(2, 0, 2)));
  EXPECT_GT(MaxAbsError(r.slice(2, 2), t.slice(2, 2)), 0.01);
}

TEST(Rope, ProductsDependOnTheDifferenceOfPositions) {
  const RopeTable table = MakeRopeTable({0, 5, 5}, 16, 100);
  const Tensor q = torch::rand({16}).expand({1, 1, 25, 16}), k = torch::rand({16}).expand({1, 1, 25, 16});
  const Tensor scores = at::matmul(Rotate(table, q)[0][0], Rotate(table, k)[0][0].t());
  EXPECT_NEAR(scores[0][7].item<double>(), scores[11][18].item<double>(), 1e-5);  // one down, two to the right
  EXPECT_GT(std::abs(scores[0][7].item<double>() - scores[0][8].item<double>()), 1e-4);
}

TEST(Rope, ViewsRepeatTheTable) {
  const RopeTable table = MakeRopeTable({1, 2, 2}, 8, 100), twice = Repeat(table, 2);
  const Tensor t = torch::rand({1, 2, 5, 8});
  const Tensor both = Rotate(twice, at::cat({t, t}, 2));
  EXPECT_TRUE(torch::equal(both.slice(2, 5), Rotate(table, t)));
}

TEST(Rope, OddWidthsAreRefused) {
  EXPECT_THROW(MakeRopeTable({1, 2, 2}, 6, 100), ShapeError);
  EXPECT_THROW(MakeRopeTable({1, 2, 2}, 0, 100), ShapeError);
}

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
