#include "oraclegs/networks/common/recognize.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "networks/fixtures.h"
#include "support/network_files.h"

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

/// A file with the names and shapes of a published network, and nothing behind them on the disk.
void WriteSparse(const std::filesystem::path& path, DepthAnythingSize size) {
  ListedParameters listed;
  LoadDepthAnything(listed, DepthAnythingV2(size));
  nlohmann::json header;
  int64_t at = 0;
  for (const auto& [name, shape] : listed.shapes()) {
    int64_t bytes = 2;
    for (const int64_t side : shape) bytes *= side;
    header[name] = {{"dtype", "F16"}, {"shape", shape}, {"data_offsets", {at, at + bytes}}};
    at += bytes;
  }
  std::string text = header.dump();
  text.resize((text.size() + 7) / 8 * 8, ' ');
  const uint64_t length = text.size();
  WriteFileAtomically(path, std::string(reinterpret_cast<const char*>(&length), 8) + text);
  std::filesystem::resize_file(path, 8 + length + static_cast<uint64_t>(at));
}

void ExpectSame(const DepthAnythingConfig& a, const DepthAnythingConfig& b) {
  EXPECT_EQ(a.backbone.width, b.backbone.width);
  EXPECT_EQ(a.backbone.depth, b.backbone.depth);
  EXPECT_EQ(a.backbone.heads, b.backbone.heads);
  EXPECT_EQ(a.backbone.patch, b.backbone.patch);
  EXPECT_EQ(a.backbone.position_grid, b.backbone.position_grid);
  EXPECT_EQ(a.layers, b.layers);
  EXPECT_EQ(a.head.width, b.head.width);
  EXPECT_EQ(a.head.features, b.head.features);
  EXPECT_EQ(a.head.channels, b.head.channels);
  EXPECT_EQ(a.input_side, b.input_side);
}

TEST(RecognizeDepthAnything, TellsThePublishedSizesByTheirShapes) {
  const TempDir dir;
  for (const DepthAnythingSize size :
       {DepthAnythingSize::kSmall, DepthAnythingSize::kBase, DepthAnythingSize::kLarge}) {
    WriteSparse(dir / "weights.safetensors", size);
    ExpectSame(RecognizeDepthAnything(dir / "weights.safetensors"), DepthAnythingV2(size));
  }
}

TEST(RecognizeDepthAnything, LoadsWhatItRecognises) {
  const TempDir dir;
  const auto path = WriteTinyDepthAnything(dir / "tiny.safetensors");
  ExpectSame(RecognizeDepthAnything(path), TinyDepthAnything());
  const DepthAnything model = LoadRecognizedDepthAnything(path);
  torch::manual_seed(3);
  const Tensor map = RelativeInverseDepth(model, torch::rand({36, 48, 3}));
  EXPECT_EQ(map.sizes(), at::IntArrayRef({36, 48}));
  EXPECT_GT(map.max().item<float>(), map.min().item<float>());
}

TEST(RecognizeDepthAnything, SaysWhatIsWrongWithAnotherFile) {
  const TempDir dir;
  const auto refuse = [&](const std::map<std::string, std::vector<int64_t>>& shapes) {
    KeptParameters parameters(1);
    for (const auto& [name, shape] : shapes) parameters.Get(name, shape);
    return parameters.Write(dir / "other.safetensors");
  };
  EXPECT_THAT(
      [&] {
        RecognizeDepthAnything(refuse({{"a", {2}}}));
      },
      ThrowsMessage<InputError>(AllOf(HasSubstr("other.safetensors: is no Depth Anything V2"),
                                      HasSubstr("no pretrained.pos_embed with 3 dimensions"))));
  EXPECT_THAT(
      [&] {
        RecognizeDepthAnything(refuse({{"pretrained.pos_embed", {4, 4}}}));
      },
      ThrowsMessage<InputError>(HasSubstr("no pretrained.pos_embed with 3 dimensions")));
  EXPECT_THAT(
      [&] {
        RecognizeDepthAnything(
            refuse({{"pretrained.pos_embed", {1, 26, 48}}, {"pretrained.patch_embed.proj.weight", {48, 3, 14, 14}}}));
      },
      ThrowsMessage<InputError>(HasSubstr("has 0 blocks of width 48 with 26 positions")));
  // One that lacks a tensor of its body.
  KeptParameters parameters(2);
  LoadDepthAnything(parameters, TinyDepthAnything());
  const auto path = parameters.Write(dir / "whole.safetensors");
  EXPECT_NO_THROW(LoadRecognizedDepthAnything(path));
  parameters.Get("surplus", {2});
  parameters.Write(path);
  EXPECT_THAT([&] { LoadRecognizedDepthAnything(path); },
              ThrowsMessage<InputError>(HasSubstr("does not hold Depth Anything V2; not part of it 1: surplus")));
}

TEST(RecognizeLpips, TellsNetworkAndWidths) {
  const TempDir dir;
  for (const FeatureNetwork network : {FeatureNetwork::kVgg16, FeatureNetwork::kAlexNet}) {
    const auto path = WriteTinyLpips(dir / "lpips.safetensors", 7, network);
    const FeatureStackConfig config = RecognizeLpips({path});
    EXPECT_EQ(config.network, network);
    EXPECT_EQ(config.channels, (std::array<int64_t, 5>{4, 6, 8, 10, 12}));
    const Lpips lpips = LoadRecognizedLpips({path});
    torch::manual_seed(3);
    const Tensor a = torch::rand({40, 50, 3}), b = torch::rand({40, 50, 3});
    EXPECT_GT(Distance(lpips, a, PrepareTarget(lpips, b, LpipsRange::kZeroOne)).value, 0);
  }
}

TEST(RecognizeLpips, FeaturesAndLinearWeightsMayStandInTwoFiles) {
  const TempDir dir;
  const auto whole = WriteTinyLpips(dir / "lpips.safetensors");
  const SafetensorsFile file = SafetensorsFile::Open(whole);
  std::map<std::string, TensorEntry> features, linear;
  for (const auto& [name, entry] : file.tensors()) (name.starts_with("lin") ? linear : features)[name] = entry;
  WriteFileAtomically(dir / "a.safetensors", SerializeSafetensors(features, {}));
  WriteFileAtomically(dir / "b.safetensors", SerializeSafetensors(linear, {}));
  EXPECT_NO_THROW(LoadRecognizedLpips({dir / "a.safetensors", dir / "b.safetensors"}));
  EXPECT_THAT([&] { LoadRecognizedLpips({dir / "a.safetensors"}); },
              ThrowsMessage<InputError>(AllOf(HasSubstr("a.safetensors: is no LPIPS"),
                                              HasSubstr("no lin0.model.1.weight with 4 dimensions"))));
}

TEST(RecognizeLpips, SaysWhatIsWrongWithAnotherFile) {
  const TempDir dir;
  KeptParameters parameters(1);
  parameters.Get("features.0.weight", {4, 3, 7, 7});
  const auto path = parameters.Write(dir / "other.safetensors");
  EXPECT_THAT([&] { RecognizeLpips({path}); },
              ThrowsMessage<InputError>(HasSubstr("its first convolution is 7 pixels wide")));
  KeptParameters wider(1);
  LoadLpips(wider, {FeatureNetwork::kVgg16, {4, 6, 8, 10, 12}});
  wider.Get("lin3.model.1.weight", {1, 11, 1, 1});
  wider.Write(path);
  EXPECT_THAT(
      [&] { LoadRecognizedLpips({path}); },
      ThrowsMessage<InputError>(AllOf(HasSubstr("does not hold LPIPS with VGG16; of another shape"),
                                      HasSubstr("features.17.weight is [10, 8, 3, 3], expected [11, 8, 3, 3]"))));
}

}  // namespace
}  // namespace oraclegs
