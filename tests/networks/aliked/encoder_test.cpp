#include "oraclegs/networks/aliked/encoder.h"

#include "networks/aliked/fixture.h"

namespace oraclegs::aliked {
namespace {

class AlikedEncoderParity : public OnThreads {};

TEST_P(AlikedEncoderParity, ScoresMatchTheReference) {
  const SafetensorsFile file = OpenGolden(kGolden);
  ExpectGolden(GoldenMaps(GoldenAliked(), file).scores, file, "score_map", 1e-5);
}

INSTANTIATE_TEST_SUITE_P(Threads, AlikedEncoderParity, testing::ValuesIn(ThreadsAndGpu()));

BlockConv RandomConv(int64_t in, int64_t out) {
  BlockConv layer;
  layer.conv = {torch::randn({out, in, 3, 3}), torch::randn({out})};
  layer.offsets = {torch::zeros({18, in, 3, 3}), torch::zeros({18})};
  return layer;
}

TEST(AlikedBlockConv, WithoutOffsetsIsAConvolution) {
  torch::manual_seed(1);
  BlockConv layer = RandomConv(3, 5);
  const Tensor x = torch::randn({1, 3, 6, 9}), y = Forward(layer, x);
  layer.offsets = {};
  EXPECT_LT((y - Forward(layer, x)).abs().max().item<float>(), 1e-5);
}

TEST(AlikedBlockConv, OffsetsAreRowsBeforeColumnsAndOutsideIsZero) {
  BlockConv layer = RandomConv(1, 1);
  layer.conv = {torch::zeros({1, 1, 3, 3}), torch::zeros({1})};
  layer.conv.weight[0][0][1][1] = 1;  // the tap in the middle, number 4
  layer.offsets.bias[8] = 1;          // reads a row below
  layer.offsets.bias[9] = -0.5;       // and half a column to the left
  const Tensor x = torch::arange(1, 21, torch::kFloat).view({1, 1, 4, 5});
  const Tensor y = Forward(layer, x)[0][0];
  EXPECT_FLOAT_EQ(y[0][1].item<float>(), (x[0][0][1][0] + x[0][0][1][1]).item<float>() / 2);
  EXPECT_FLOAT_EQ(y[0][0].item<float>(), x[0][0][1][0].item<float>() / 2);
  EXPECT_EQ(y[3].abs().max().item<float>(), 0);
}

TEST(AlikedBlockConv, OffsetsReachAQuarterOfTheLongerSide) {
  BlockConv layer = RandomConv(1, 1);
  layer.conv = {torch::zeros({1, 1, 3, 3}), torch::zeros({1})};
  layer.conv.weight[0][0][1][1] = 1;
  layer.offsets.bias[9] = 100;
  const Tensor x = torch::arange(1, 25, torch::kFloat).view({1, 1, 3, 8});
  EXPECT_FLOAT_EQ(Forward(layer, x)[0][0][0][0].item<float>(), x[0][0][0][2].item<float>());
}

TEST(AlikedEncoder, TakesImagesOfAnySize) {
  const Aliked network = GoldenAliked();
  const int before = at::get_num_threads();
  torch::manual_seed(2);
  for (const auto& [height, width] : {std::pair{1, 1}, std::pair{31, 64}, std::pair{97, 130}}) {
    const Tensor rgb = torch::rand({height, width, 3});
    at::set_num_threads(1);
    const FeatureMaps one = Forward(network.encoder, rgb);
    at::set_num_threads(3);
    const FeatureMaps three = Forward(network.encoder, rgb);
    EXPECT_EQ(one.scores.sizes(), (std::vector<int64_t>{height, width}));
    EXPECT_TRUE(torch::isfinite(one.scores).all().item<bool>());
    EXPECT_LT(MaxAbsError(one.scores, three.scores), 1e-5) << height;
    EXPECT_EQ(one.maps[0].size(2) % 32, 0);
    EXPECT_EQ(one.maps[3].size(3), (width + 31) / 32);
  }
  at::set_num_threads(before);
  EXPECT_THROW(Forward(network.encoder, torch::rand({3, 20, 20})), ShapeError);
  EXPECT_THROW(Forward(network.encoder, torch::rand({0, 20, 3})), ShapeError);
}

}  // namespace
}  // namespace oraclegs::aliked
