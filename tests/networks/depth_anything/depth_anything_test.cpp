#include "oraclegs/networks/depth_anything/depth_anything.h"

#include "networks/fixtures.h"
#include "oraclegs/core/files.h"

namespace oraclegs {
namespace {

constexpr const char* kFixture = "depth_anything_v2_tiny";

DepthAnythingConfig GoldenConfig(const SafetensorsFile& file) {
  DepthAnythingConfig config;
  VitConfig& backbone = config.backbone;
  backbone.width = Count(file, "embed_dim");
  backbone.depth = Count(file, "depth");
  backbone.heads = Count(file, "num_heads");
  backbone.mlp_ratio = Count(file, "mlp_ratio");
  backbone.patch = Count(file, "patch_size");
  backbone.position_grid = Count(file, "img_size") / backbone.patch;
  backbone.registers = Count(file, "num_register_tokens");
  backbone.norm_eps = Number(file, "norm_eps");
  backbone.position_offset = Number(file, "pos_embed_offset");
  backbone.position_antialias = file.metadata().at("pos_embed_antialias") == "true";
  config.layers = Counts<4>(file, "layers");
  config.head.width = backbone.width;
  config.head.features = Count(file, "features");
  config.head.channels = Counts<4>(file, "out_channels");
  config.head.patch = backbone.patch;
  return config;
}

class DepthAnythingParity : public OnThreads {};

TEST_P(DepthAnythingParity, MatchesTheOfficialNetwork) {
  const SafetensorsFile file = OpenGolden(kFixture);
  FileParameters source = GoldenWeights(kFixture);
  const DepthAnything model = LoadDepthAnything(source, GoldenConfig(file));
  source.Finish();
  const PatchGrid grid{Count(file, "height") / model.config.backbone.patch,
                       Count(file, "width") / model.config.backbone.patch};
  const Tensor input = GoldenFloat(file, "input.normalized");
  EXPECT_LT(MaxAbsError(NormalizeRgb(GoldenFloat(file, "input.image_rgb")), input), 1e-5);

  ExpectGolden(PositionEmbedding(model.backbone, grid.rows, grid.cols), file, "debug.pos_embed", 1e-6);
  ExpectGolden(EmbedImages(model.backbone, input), file, "debug.tokens_in", 1e-5);
  const std::vector<Tensor> tokens =
      LayerTokens(model.backbone, input, {model.config.layers.begin(), model.config.layers.end()});
  const std::array<Tensor, 4> patches = HeadLayers(model, input);
  for (size_t i = 0; i < 4; ++i) {
    ExpectGolden(patches[i], file, "output.intermediate." + std::to_string(i), 1e-4);
    ExpectGolden(tokens[i].select(1, 0), file, "output.intermediate_cls." + std::to_string(i), 1e-4);
  }
  const std::array<Tensor, 4> fused = FuseLayers(model.head, patches, grid);
  for (size_t k = 1; k <= 4; ++k) ExpectGolden(fused[k - 1], file, "debug.refinenet" + std::to_string(k), 1e-4);

  const Tensor depth = Forward(model, input);
  ExpectGolden(depth, file, "output.depth", 1e-4);
  const Tensor resized = ResizeBilinear(depth.unsqueeze(0), Count(file, "resized_height"), Count(file, "resized_width"),
                                        Corners::kAligned);
  ExpectGolden(resized[0][0], file, "output.depth_resized", 1e-4);
}

TEST_P(DepthAnythingParity, PreparesImagesAsTheOfficialCode) {
  const SafetensorsFile file = OpenGolden(kFixture);
  const Tensor rgb = GoldenFloat(file, "preproc.source_rgb_u8") / 255;
  const Tensor resized = ResizeForDepthAnything(rgb, Count(file, "preproc_input_size"), Count(file, "patch_size"));
  ExpectGolden(resized[0], file, "preproc.resized_rgb", 1e-5);
  ExpectGolden(NormalizeRgb(resized)[0], file, "preproc.normalized", 5e-5);
}

INSTANTIATE_TEST_SUITE_P(Threads, DepthAnythingParity, testing::ValuesIn(ThreadsAndGpu()));

TEST(DepthAnything, SameBitsForAnyNumberOfThreads) {
  const SafetensorsFile file = OpenGolden(kFixture);
  FileParameters source = GoldenWeights(kFixture);
  const DepthAnything model = LoadDepthAnything(source, GoldenConfig(file));
  const auto run = [&](int threads) {
    at::set_num_threads(threads);
    return Forward(model, GoldenFloat(file, "input.normalized"));
  };
  const int before = at::get_num_threads();
  const Tensor one = run(1), three = run(3);
  at::set_num_threads(before);
  EXPECT_TRUE(torch::equal(one, three));
}

TEST(DepthAnything, NamesAndShapesAreThoseOfThePublishedNetworks) {
  for (const auto& [size, list] : {std::pair{DepthAnythingSize::kSmall, "depth_anything_v2_vits_params.tsv"},
                                   std::pair{DepthAnythingSize::kBase, "depth_anything_v2_vitb_params.tsv"},
                                   std::pair{DepthAnythingSize::kLarge, "depth_anything_v2_vitl_params.tsv"}}) {
    ListedParameters parameters;
    LoadDepthAnything(parameters, DepthAnythingV2(size));
    const auto expected = GoldenParameterList(list);
    ASSERT_GT(expected.size(), 200u) << list;
    EXPECT_EQ(parameters.shapes(), expected) << list;
  }
}

TEST(DepthAnything, BothSidesReachTheTargetInWholePatches) {
  const auto size = [](int64_t height, int64_t width) {
    const Tensor x = ResizeForDepthAnything(torch::rand({height, width, 3}), 518, 14);
    return std::pair{x.size(2), x.size(3)};
  };
  EXPECT_EQ(size(375, 500), (std::pair<int64_t, int64_t>{518, 686}));  // 690.7 is nearer to 49 patches than to 50
  EXPECT_EQ(size(500, 375), (std::pair<int64_t, int64_t>{686, 518}));
  EXPECT_EQ(size(300, 300), (std::pair<int64_t, int64_t>{518, 518}));
  EXPECT_EQ(size(100, 101), (std::pair<int64_t, int64_t>{518, 518}));  // 523.2: rounds down, not below the target
}

TEST(DepthAnything, AnswersAtTheImagesSize) {
  const SafetensorsFile file = OpenGolden(kFixture);
  FileParameters source = GoldenWeights(kFixture);
  DepthAnythingConfig config = GoldenConfig(file);
  config.input_side = 56;
  const Tensor map = RelativeInverseDepth(LoadDepthAnything(source, config), torch::rand({40, 51, 3}));
  EXPECT_EQ(map.sizes(), at::IntArrayRef({40, 51}));
  EXPECT_TRUE(map.is_contiguous());
  EXPECT_GE(map.min().item<float>(), 0);
}

TEST(DepthAnything, AFileOfAnotherNetworkIsRefusedByName) {
  EXPECT_THAT([] { LoadDepthAnything(GoldenDir() / "lpips_tiny.safetensors", DepthAnythingSize::kSmall); },
              testing::ThrowsMessage<InputError>(
                  testing::AllOf(testing::HasSubstr("lpips_tiny.safetensors: does not hold Depth Anything V2 S"),
                                 testing::HasSubstr("missing 234: "), testing::HasSubstr("not part of it"))));
}

TEST(DepthAnything, RefusesWhatIsNoImage) {
  EXPECT_THROW(ResizeForDepthAnything(torch::rand({3, 40, 50}), 518, 14), ShapeError);
  EXPECT_THROW(ResizeForDepthAnything(torch::rand({0, 50, 3}), 518, 14), ShapeError);
  EXPECT_THROW(ResizeForDepthAnything(torch::rand({40, 50, 3}, torch::kDouble), 518, 14), ShapeError);
}

}  // namespace
}  // namespace oraclegs
