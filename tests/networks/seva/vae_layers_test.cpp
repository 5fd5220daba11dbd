#include "oraclegs/networks/seva/vae_layers.h"

#include "networks/seva/vae_fixture.h"

namespace oraclegs::seva {
namespace {

constexpr VaeNormShape kNorm{4, 1e-6};

TEST(VaeLayers, AShortcutIsLearnedOnlyWhereTheChannelsChange) {
  ListedParameters same, wider;
  EXPECT_FALSE(LoadVaeResnet(ParameterScope(same), 8, 8, kNorm).shortcut);
  EXPECT_TRUE(LoadVaeResnet(ParameterScope(wider), 8, 12, kNorm).shortcut);
  EXPECT_EQ(same.shapes().count("conv_shortcut.weight"), 0u);
  EXPECT_EQ(wider.shapes().at("conv_shortcut.weight"), (std::vector<int64_t>{12, 8, 1, 1}));
}

TEST(VaeLayers, ASilentResnetPassesItsInput) {
  RandomParameters source(1);
  VaeResnet block = LoadVaeResnet(ParameterScope(source), 8, 8, kNorm);
  block.conv2.weight.zero_();
  block.conv2.bias.zero_();
  const Tensor x = torch::rand({2, 8, 5, 6});
  EXPECT_TRUE(torch::equal(Forward(block, x), x));
}

TEST(VaeLayers, AttentionIsTheSoftmaxOverAllPlaces) {
  RandomParameters source(2);
  const VaeAttention attention = LoadVaeAttention(ParameterScope(source), 8, kNorm);
  const Tensor x = torch::rand({2, 8, 3, 5});
  const Tensor n = Forward(attention.norm, x).flatten(2).transpose(1, 2);
  const Tensor q = Forward(attention.q, n), k = Forward(attention.k, n), v = Forward(attention.v, n);
  const Tensor weights = at::softmax(at::matmul(q, k.transpose(1, 2)) / std::sqrt(8.0), -1);
  const Tensor expected = x + Forward(attention.out, at::matmul(weights, v)).transpose(1, 2).reshape(x.sizes());
  EXPECT_LT(MaxAbsError(Forward(attention, x), expected), 1e-6);
}

/// A level without residual blocks whose convolution reads one of its nine places.
VaeLevel Reader(VaeResample resample, int64_t row, int64_t column) {
  RandomParameters source(3);
  VaeLevel level = LoadVaeLevel(ParameterScope(source), {1, 1, 0, resample}, kNorm);
  level.conv->weight.zero_();
  level.conv->bias.zero_();
  level.conv->weight[0][0][row][column] = 1;
  return level;
}

TEST(VaeLayers, HalvingPadsTheRightAndTheBottom) {
  const Tensor x = torch::rand({1, 1, 4, 6});
  const Tensor even = x.slice(2, 0, 4, 2).slice(3, 0, 6, 2);
  EXPECT_TRUE(torch::equal(Forward(Reader(VaeResample::kHalve, 0, 0), x), even));
  const Tensor next = Forward(Reader(VaeResample::kHalve, 2, 2), x);
  ASSERT_EQ(next.sizes(), at::IntArrayRef({1, 1, 2, 3}));
  EXPECT_EQ(next[0][0][0][0].item<float>(), x[0][0][2][2].item<float>());
  EXPECT_EQ(next[0][0][1].abs().max().item<float>(), 0);
  EXPECT_EQ(next.select(3, 2).abs().max().item<float>(), 0);
}

TEST(VaeLayers, DoublingRepeatsPixelsBeforeItsConvolution) {
  const Tensor x = torch::rand({1, 1, 2, 3});
  const Tensor y = Forward(Reader(VaeResample::kDouble, 1, 1), x);
  EXPECT_TRUE(torch::equal(y, x.repeat_interleave(2, 2).repeat_interleave(2, 3)));
}

TEST(VaeLayers, ALevelThatKeepsItsSizeHasNoConvolutionOfItsOwn) {
  ListedParameters list;
  EXPECT_FALSE(LoadVaeLevel(ParameterScope(list), {4, 8, 2, VaeResample::kKeep}, kNorm).conv);
  for (const auto& [name, shape] : list.shapes()) EXPECT_TRUE(name.starts_with("resnets.")) << name;
}

class VaeLayersParity : public OnThreads {};

TEST_P(VaeLayersParity, MatchTheOfficialBlocks) {
  const SafetensorsFile file = OpenGolden(kVaeFixture);
  const Vae vae = GoldenVae(file);
  Tensor x = Forward(vae.encoder.conv_in, GoldenFloat(file, "input.image"));
  ExpectGoldenVae(x, file, "inter.encoder.conv_in");
  ExpectGoldenVae(Forward(vae.encoder.levels[0].resnets[0], x), file, "inter.encoder.down_blocks.0.resnets.0");
  for (size_t i = 0; i < vae.encoder.levels.size(); ++i) {
    x = Forward(vae.encoder.levels[i], x);
    if (i == 0) ExpectGoldenVae(x, file, "inter.encoder.down_blocks.0");
  }
  const VaeMiddle& middle = vae.encoder.middle;
  ExpectGoldenVae(Forward(middle.attention, Forward(middle.first, x)), file, "inter.encoder.mid_block.attentions.0");
  ExpectGoldenVae(Forward(middle, x), file, "inter.encoder.mid_block");
  x = DecodeMiddle(vae.decoder, GoldenFloat(file, "input.latent"));
  ExpectGoldenVae(x, file, "inter.decoder.mid_block");
  ExpectGoldenVae(Forward(vae.decoder.levels[0], x), file, "inter.decoder.up_blocks.0");
}

INSTANTIATE_TEST_SUITE_P(Threads, VaeLayersParity, testing::ValuesIn(ThreadsAndGpu()));

}  // namespace
}  // namespace oraclegs::seva
