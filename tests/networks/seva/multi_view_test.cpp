#include "oraclegs/networks/seva/multi_view.h"

#include "networks/seva/unet_fixture.h"

namespace oraclegs::seva {
namespace {

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
