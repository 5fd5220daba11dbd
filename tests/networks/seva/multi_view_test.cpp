#include "oraclegs/networks/seva/multi_view.h"
#include "networks/fixtures.h"
#include "oraclegs/networks/common/autocast.h"

#include "networks/seva/unet_fixture.h"

namespace oraclegs::seva {
namespace {

FeedForward Layer() {
  RandomParameters source(4);
  return LoadFeedForward(ParameterScope(source), 256);
}
Tensor SineTokens(int64_t tokens) { return at::sin(at::arange(tokens * 256) * 0.7).view({1, tokens, 256}); }

TEST(SevaFeedForward, HalfOfTheProductGatesTheOther) {
  const FeedForward layer = Layer();
  const Tensor x = SineTokens(5), both = at::linear(x, layer.in.weight, layer.in.bias);
  const Tensor expected =
      at::linear(both.slice(2, 0, 1024) * at::gelu(both.slice(2, 1024, 2048)), layer.out.weight, layer.out.bias);
  const Addend out = Forward(layer, x);
  EXPECT_EQ(out.rows.sizes(), x.sizes());
  EXPECT_LE(MaxAbsError(out.rows, expected), 1e-5);
  EXPECT_FALSE(out.vectors.defined());
}

TEST(SevaFeedForward, SlicesDoNotChangeIt) {
  const FeedForward layer = Layer();
  const Tensor x = SineTokens(5000);  // 2048 numbers a token: slices of 2048 tokens
  const Tensor all = Forward(layer, x).rows;
  for (const int64_t t : {0, 2047, 2048, 4999}) {
    EXPECT_LE(MaxAbsError(all.slice(1, t, t + 1), Forward(layer, x.slice(1, t, t + 1)).rows), 1e-5) << t;
  }
}

TEST(SevaFeedForward, WithinAutocastRowsHaveItsType) {
  const FeedForward layer = Layer();
  const Tensor x = SineTokens(3000), exact = Forward(layer, x).rows;
  const Autocast scope(torch::kCPU, torch::kBFloat16);
  const Tensor rows = Forward(layer, x).rows;
  EXPECT_EQ(rows.scalar_type(), torch::kBFloat16);
  EXPECT_LE(RelativeL2(rows, exact), 0.02);
}

TEST(SevaMultiView, OneAloneMatchesTheOfficialNetwork) {
  const GoldenUnet golden;
  const auto& block = std::get<MultiView>(golden.unet.input_blocks.at(1).at(1));
  const int64_t frames = golden.conditions.frames;
  const MultiViewContext context = PrepareContext(block, golden.conditions.context, frames);
  ExpectGoldenRatio(Forward(block, GoldenFloat(golden.file, "input.probe_mv_x"), context, frames), golden.file,
                    "output.probe_mv");
}

TEST(SevaMultiView, OfAllFramesMatchesTheOfficialNetwork) {
  const GoldenUnet golden;
  const auto& block = std::get<MultiView>(golden.unet.middle.at(1));
  ASSERT_EQ(block.reach, Reach::kSequence);
  const int64_t frames = golden.conditions.frames;
  const MultiViewContext context = PrepareContext(block, golden.conditions.context, frames);
  ExpectGoldenRatio(Forward(block, GoldenFloat(golden.file, "inter.middle_block.0"), context, frames), golden.file,
                    "inter.middle_block.1");
}

TEST(SevaMultiView, SequencesDoNotSeeEachOther) {
  RandomParameters source(1);
  const MultiView block = LoadMultiView(ParameterScope(source), {32, 16, 2, 24, 32, Reach::kSequence});
  const Tensor x = at::sin(at::arange(6 * 32 * 4 * 2) * 0.7).view({6, 32, 4, 2});
  const Tensor context = at::cos(at::arange(6 * 24) * 0.3).view({6, 1, 24});
  const Tensor both = Forward(block, x, PrepareContext(block, context, 3), 3);
  const Tensor second = Forward(block, x.slice(0, 3), PrepareContext(block, context.slice(0, 3), 3), 3);
  EXPECT_LE(MaxAbsError(both.slice(0, 3), second), 1e-5);
}

TEST(SevaMultiView, RefusesHeadsThatDoNotDivideTheChannels) {
  ListedParameters source;
  EXPECT_THROW(LoadMultiView(ParameterScope(source), {32, 24}), ShapeError);
}

}  // namespace

}  // namespace oraclegs::seva
