#include "oraclegs/networks/seva/unet.h"

#include <ATen/autocast_mode.h>

#include "networks/seva/unet_fixture.h"
#include "oraclegs/core/files.h"
#include "oraclegs/networks/seva/kernels.h"
#include "support/temp_dir.h"

namespace oraclegs::seva {
namespace {

class SevaUnetParity : public OnThreads {};

TEST_P(SevaUnetParity, EveryStageMatchesTheOfficialNetwork) {
  const GoldenUnet golden;
  const Unet& unet = golden.unet;
  const SafetensorsFile& file = golden.file;
  const Conditioning conditioning = Prepare(unet, golden.conditions);
  const Tensor embedding = golden.Embedding();
  ExpectGoldenRatio(TimeEmbedding(unet, golden.steps), file, "inter.time_embed");
  const Tensor first = Forward(unet.input_blocks.at(0), golden.x, embedding, conditioning);
  ExpectGoldenRatio(first, file, "inter.input_blocks.0");
  ExpectGoldenRatio(Forward(unet.input_blocks.at(1), first, embedding, conditioning), file, "inter.input_blocks.1");
  std::vector<Tensor> skips;
  Tensor y = golden.x;
  for (const UnetBlock& block : unet.input_blocks) {
    y = Forward(block, y, embedding, conditioning);
    skips.push_back(y);
  }
  ExpectGoldenRatio(Forward(UnetBlock{unet.middle.at(0)}, y, embedding, conditioning), file, "inter.middle_block.0");
  y = Forward(unet.middle, y, embedding, conditioning);
  ExpectGoldenRatio(y, file, "inter.middle_block");
  y = Forward(unet.output_blocks.at(0), at::cat({y, skips.back()}, 1), embedding, conditioning);
  ExpectGoldenRatio(y, file, "inter.output_blocks.0");
  ExpectGoldenRatio(Forward(unet, golden.x, golden.steps, conditioning), file, "output.out");
}

TEST_P(SevaUnetParity, SeveralContextTokensMatch) {
  GoldenUnet golden;
  golden.conditions.context = GoldenFloat(golden.file, "input.crossattn_multi");
  const Conditioning conditioning = Prepare(golden.unet, golden.conditions);
  ExpectGoldenRatio(Forward(golden.unet, golden.x, golden.steps, conditioning), golden.file,
                    "output.out_crossattn_multi");
}

TEST_P(SevaUnetParity, RaysOfAnotherSizeMatch) {
  GoldenUnet golden;
  golden.conditions.dense = GoldenFloat(golden.file, "input.dense_vector_lowres");
  const Conditioning conditioning = Prepare(golden.unet, golden.conditions);
  ExpectGoldenRatio(Forward(golden.unet, golden.x, golden.steps, conditioning), golden.file, "output.out_dense_lowres");
}

TEST_P(SevaUnetParity, SmallInputsMatch) {
  const GoldenUnet golden;
  const Tensor x = golden.x * GoldenFloat(golden.file, "input.small_factor");
  const Conditioning conditioning = Prepare(golden.unet, golden.conditions);
  ExpectGoldenRatio(Forward(golden.unet, x, golden.steps, conditioning), golden.file, "output.out_small");
}

TEST_P(SevaUnetParity, ChannelsLastMatch) {
  GoldenUnet golden;
  KeepChannelsLast(&golden.unet);
  const Conditioning conditioning = Prepare(golden.unet, golden.conditions);
  const Tensor first = Forward(golden.unet.input_blocks.at(0), golden.x.contiguous(at::MemoryFormat::ChannelsLast),
                               golden.Embedding(), conditioning);
  EXPECT_TRUE(HasChannelsLast(first));
  EXPECT_TRUE(HasChannelsLast(Forward(golden.unet.input_blocks.at(1), first, golden.Embedding(), conditioning)));
  const Tensor out = Forward(golden.unet, golden.x, golden.steps, conditioning);
  EXPECT_TRUE(out.is_contiguous());
  ExpectGoldenRatio(out, golden.file, "output.out");
}

INSTANTIATE_TEST_SUITE_P(Threads, SevaUnetParity, testing::ValuesIn(ThreadsAndGpu()));

TEST(SevaUnet, SameBitsForAnyNumberOfThreads) {
  const GoldenUnet golden;
  const auto run = [&](int threads) {
    at::set_num_threads(threads);
    return Forward(golden.unet, golden.x, golden.steps, Prepare(golden.unet, golden.conditions));
  };
  const int before = at::get_num_threads();
  const Tensor one = run(1), three = run(3);
  at::set_num_threads(before);
  EXPECT_TRUE(torch::equal(one, three));
}

TEST(SevaUnet, NamesAndShapesAreThoseOfThePublishedNetwork) {
  ListedParameters parameters;
  LoadUnet(parameters, UnetConfig());
  const auto expected = GoldenParameterList("seva_unet_params.tsv");
  ASSERT_EQ(expected.size(), 1146u);
  EXPECT_EQ(parameters.shapes(), expected);
}

/// A checkpoint of the fixture's weights with other beginnings of the names.
std::string Renamed(const SafetensorsFile& file, const std::string& prefix) {
  std::map<std::string, TensorEntry> tensors;
  for (const auto& [name, entry] : file.tensors()) {
    if (name.starts_with("weights.")) tensors[prefix + name.substr(8)] = entry;
  }
  return SerializeSafetensors(tensors, {});
}

TEST(SevaUnet, LoadsFilesWithAndWithoutTheirPrefix) {
  const GoldenUnet golden;
  const Conditioning conditioning = Prepare(golden.unet, golden.conditions);
  const Tensor expected = Forward(golden.unet, golden.x, golden.steps, conditioning);
  const TempDir dir;
  for (const std::string prefix : {"", "module."}) {
    WriteFileAtomically(dir / "model.safetensors", Renamed(golden.file, prefix));
    const Unet unet = LoadUnet({dir / "model.safetensors"}, GoldenUnetConfig(golden.file));
    EXPECT_TRUE(torch::equal(Forward(unet, golden.x, golden.steps, conditioning), expected)) << prefix;
  }
}

TEST(SevaUnet, NamesWhatAFileLacks) {
  const GoldenUnet golden;
  const TempDir dir;
  WriteFileAtomically(dir / "model.safetensors", Renamed(golden.file, "unet."));
  try {
    LoadUnet({dir / "model.safetensors"}, GoldenUnetConfig(golden.file));
    FAIL() << "loaded";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::AllOf(testing::HasSubstr("the UNet of Stable Virtual Camera"),
                                             testing::HasSubstr("missing"), testing::HasSubstr("time_embed.0.weight")));
  }
}

TEST_P(SevaUnetParity, BFloat16StaysClose) {
  const GoldenUnet golden;
  const TempDir dir;
  WriteFileAtomically(dir / "model.safetensors", Renamed(golden.file, ""));
  const auto error = [&](bool channels_last) {
    Unet unet =
        LoadUnet({dir / "model.safetensors"}, GoldenUnetConfig(golden.file), {ParityDevice(), torch::kBFloat16});
    EXPECT_EQ(unet.channels_last, kernels::CanTake(unet.any_weight()));
    if (channels_last) KeepChannelsLast(&unet);
    const Tensor out = Forward(unet, golden.x, golden.steps, Prepare(unet, golden.conditions));
    EXPECT_EQ(out.scalar_type(), torch::kFloat);
    return RelativeL2(out, GoldenTensor(golden.file, "output.out"));
  };
  const double loaded = error(false), last = error(true);
  RecordProperty("as_loaded", std::to_string(loaded));  // on a GPU with channels last, too
  RecordProperty("channels_last", std::to_string(last));
  EXPECT_LE(loaded, kMaxHalfError);
  EXPECT_LE(last, kMaxHalfError);
}

TEST(SevaUnet, AutocastComputesProductsInHalfAndSumsInFloat) {
  const GoldenUnet golden;
  const TempDir dir;
  WriteFileAtomically(dir / "model.safetensors", Renamed(golden.file, ""));
  const auto error = [&](const Placement& placement) {
    const Unet unet = LoadUnet({dir / "model.safetensors"}, GoldenUnetConfig(golden.file), placement);
    EXPECT_EQ(unet.any_weight().scalar_type(), placement.type);
    const Tensor out = Forward(unet, golden.x, golden.steps, Prepare(unet, golden.conditions));
    EXPECT_EQ(out.scalar_type(), torch::kFloat);
    return RelativeL2(out, GoldenTensor(golden.file, "output.out"));
  };
  const double exact = error({torch::kCPU, torch::kFloat, {}});
  const double mixed = error({torch::kCPU, torch::kFloat, torch::kBFloat16});
  const double half = error({torch::kCPU, torch::kBFloat16, {}});
  EXPECT_GT(mixed, 10 * exact);
  EXPECT_NE(mixed, half) << "sums are in half, too";
  EXPECT_LT(mixed, 1.05 * half);  // not always less: CPUs without bfloat16 round within products, in both
  EXPECT_FALSE(at::autocast::is_cpu_enabled()) << "left on";
}

TEST(SevaUnet, RefusesWhatDoesNotFit) {
  const GoldenUnet golden;
  const Conditioning conditioning = Prepare(golden.unet, golden.conditions);
  EXPECT_THROW(Forward(golden.unet, golden.x.slice(1, 0, 4), golden.steps, conditioning), ShapeError);
  EXPECT_THROW(Forward(golden.unet, golden.x, golden.steps.slice(0, 1), conditioning), ShapeError);
  EXPECT_THROW(Forward(golden.unet, golden.x.slice(2, 0, 8), golden.steps, conditioning), ShapeError);
  Conditions odd = golden.conditions;
  odd.height += 1;
  EXPECT_THROW(Prepare(golden.unet, odd), ShapeError);
  odd = golden.conditions;
  odd.frames = odd.context.size(0) + 1;
  EXPECT_THROW(Prepare(golden.unet, odd), ShapeError);
  ListedParameters parameters;
  UnetConfig config;
  config.transformer_depth.pop_back();
  EXPECT_THROW(LoadUnet(parameters, config), ShapeError);
}

}  // namespace
}  // namespace oraclegs::seva
