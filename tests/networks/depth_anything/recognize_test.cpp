#include "oraclegs/networks/depth_anything/depth_anything.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "networks/fixtures.h"
#include "networks/network_files.h"
#include "oraclegs/networks/common/tensor.h"
#include "support/temp_dir.h"

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

TEST(RecognizeDepthAnything, KnowsThePublishedSizesByTheirShapes) {
  const TempDir dir;
  for (const DepthAnythingSize size :
       {DepthAnythingSize::kSmall, DepthAnythingSize::kBase, DepthAnythingSize::kLarge}) {
    WriteSparse(dir / "weights.safetensors", size);
    ExpectSame(RecognizeDepthAnything(dir / "weights.safetensors"), DepthAnythingV2(size));
  }
}

TEST(RecognizeDepthAnything, LoadsWhatItRecognizes) {
  const TempDir dir;
  const auto path = MakeTinyDepthAnything(dir / "tiny.safetensors");
  ExpectSame(RecognizeDepthAnything(path), TinyDepthAnything());
  const DepthAnything model = LoadRecognizedDepthAnything(path);
  torch::manual_seed(3);
  const Tensor map = RelativeInverseDepth(model, torch::rand({36, 48, 3}));
  EXPECT_EQ(map.sizes(), at::IntArrayRef({36, 48}));
  EXPECT_GT(map.max().item<float>(), map.min().item<float>());
}

TEST(LoadDepthNetwork, GivesTheMapOfTheNetwork) {
  const TempDir dir;
  const auto path = MakeTinyDepthAnything(dir / "tiny.safetensors");
  torch::manual_seed(3);
  const Tensor rgb = torch::rand({36, 48, 3});
  const ImageF image{48, 36, 3, {rgb.data_ptr<float>(), rgb.data_ptr<float>() + rgb.numel()}};
  const Tensor expected = RelativeInverseDepth(LoadRecognizedDepthAnything(path), rgb);
  const Buffer<float> map = LoadDepthNetwork(path)->InverseDepth(image);
  EXPECT_EQ(map.shape(), (Shape{36, 48}));
  EXPECT_TRUE(std::equal(map.span().begin(), map.span().end(), expected.data_ptr<float>()));
}

TEST(LoadDepthNetwork, KnowsHowTheDepthFollowsFromTheImage) {
  const TempDir dir;
  const auto network = LoadDepthNetwork(MakeTinyDepthAnything(dir / "tiny.safetensors"));
  torch::manual_seed(4);
  const Tensor rgb = torch::rand({36, 48, 3}), weights = torch::randn({36, 48}), way = torch::randn({36, 48, 3});
  const auto depth = [&](const Tensor& t) {
    return TensorOf(network->InverseDepth({48, 36, 3, {t.data_ptr<float>(), t.data_ptr<float>() + t.numel()}}));
  };
  const Tensor gradient = TensorOf(network->ImageGradient(BufferOf(rgb), [&](const Buffer<float>& seen) {
    EXPECT_TRUE(torch::equal(TensorOf(seen), depth(rgb)));
    return BufferOf(weights);
  }));
  const auto loss = [&](double step) {
    return (depth((rgb + step * way).contiguous()).to(torch::kDouble) * weights).sum().item<double>();
  };
  constexpr double kStep = 1e-3;
  const double expected = (loss(kStep) - loss(-kStep)) / (2 * kStep);
  EXPECT_NEAR((gradient.to(torch::kDouble) * way).sum().item<double>(), expected, 0.02 * std::abs(expected));
}

TEST(DepthNetworkName, AgreesWithThePublishedSizes) {
  const TempDir dir;
  for (const auto& [size, name] : {std::pair{DepthAnythingSize::kSmall, "Depth Anything V2 small"},
                                   std::pair{DepthAnythingSize::kBase, "Depth Anything V2 base"},
                                   std::pair{DepthAnythingSize::kLarge, "Depth Anything V2 large"}}) {
    WriteSparse(dir / "weights.safetensors", size);
    EXPECT_EQ(DepthNetworkName(dir / "weights.safetensors"), name);
  }
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
  // One that has a tensor too much.
  KeptParameters parameters(2);
  LoadDepthAnything(parameters, TinyDepthAnything());
  const auto path = parameters.Write(dir / "whole.safetensors");
  EXPECT_NO_THROW(LoadRecognizedDepthAnything(path));
  parameters.Get("surplus", {2});
  parameters.Write(path);
  EXPECT_NO_THROW(LoadRecognizedDepthAnything(path)) << "a surplus tensor harms nothing";
}

}  // namespace
}  // namespace oraclegs
