#include "oraclegs/networks/seva/res_block.h"

#include "networks/seva/unet_fixture.h"

namespace oraclegs::seva {
namespace {

TEST(SevaResBlock, MatchesTheOfficialNetwork) {
  const GoldenUnet golden;
  const Conditioning conditioning = Prepare(golden.unet, golden.conditions);
  const auto& block = std::get<ResBlock>(golden.unet.input_blocks.at(1).at(0));
  const Tensor x = GoldenFloat(golden.file, "inter.input_blocks.0");
  ExpectGoldenRatio(Forward(block, x, golden.Embedding(), conditioning.dense.front()), golden.file,
                    "inter.input_blocks.1.0");
}

TEST(SevaResBlock, SlicesOfFramesDoNotChangeTheModulation) {
  RandomParameters source(5);
  const ResBlock block = LoadResBlock(ParameterScope(source), {64, 32, 48, 6, 32});
  const auto noise = [](at::IntArrayRef shape) {
    return at::sin(at::arange(c10::multiply_integers(shape)) * 1.7).view(shape);
  };
  // 96 x 96 x 128 numbers a frame: three frames at a time.
  const Tensor x = noise({7, 64, 96, 96}), embedding = noise({7, 48}), dense = noise({7, 6, 96, 96});
  const Tensor all = Forward(block, x, embedding, dense);
  for (const int64_t t : {0, 3, 6}) {
    const Tensor one = Forward(block, x.slice(0, t, t + 1), embedding.slice(0, t, t + 1), dense.slice(0, t, t + 1));
    EXPECT_LE(MaxAbsError(all.slice(0, t, t + 1), one), 1e-4) << t;
  }
}

}  // namespace
}  // namespace oraclegs::seva
