#include "oraclegs/networks/seva/openclip.h"

#include <cmath>

#include "networks/fixtures.h"
#include "oraclegs/core/files.h"
#include "support/temp_dir.h"

namespace oraclegs::seva {
namespace {

class OpenClipInputParity : public OnThreads {};

TEST_P(OpenClipInputParity, PreparesImagesAsTheOfficialCode) {
  const SafetensorsFile file = OpenGolden("openclip_visual_tiny");
  const int64_t side = Count(file, "image_size");
  for (const std::string suffix : {"", "_b"}) {
    const std::string name = "inter.preprocessed" + suffix;
    const double largest = GoldenTensor(file, name).abs().max().item<double>();
    ExpectGolden(PrepareOpenClipInput(GoldenFloat(file, "input.image" + suffix), side), file, name, 1e-4 * largest);
  }
}

INSTANTIATE_TEST_SUITE_P(Threads, OpenClipInputParity, testing::ValuesIn(ThreadsAndGpu()));

TEST(OpenClipInput, SameBitsForAnyNumberOfThreads) {
  const SafetensorsFile file = OpenGolden("openclip_visual_tiny");
  const auto run = [&](int threads) {
    at::set_num_threads(threads);
    return PrepareOpenClipInput(GoldenFloat(file, "input.image"));
  };
  const int before = at::get_num_threads();
  const Tensor one = run(1), three = run(3);
  at::set_num_threads(before);
  EXPECT_TRUE(torch::equal(one, three));
}

TEST(OpenClipInput, TheBlurIsAsWideAsTheAxisShrinks) {
  // Factor 3: sigma 1, 4 taps, made odd.
  const std::vector<double> weights = ResizeBlurWeights(672, 224);
  ASSERT_EQ(weights.size(), 5u);
  double sum = 0;
  for (size_t i = 0; i < 5; ++i) {
    sum += weights[i];
    const double distance = static_cast<double>(i) - 2;
    EXPECT_NEAR(weights[i] / weights[2], std::exp(-distance * distance / 2), 1e-12);
  }
  EXPECT_NEAR(sum, 1, 1e-12);
  EXPECT_EQ(ResizeBlurWeights(576, 224).size(), 3u);    // 3.14
  EXPECT_EQ(ResizeBlurWeights(1792, 224).size(), 15u);  // 14
}

TEST(OpenClipInput, AnAxisThatGrowsIsNotBlurred) {
  const std::vector<double> weights = ResizeBlurWeights(100, 224);
  ASSERT_EQ(weights.size(), 3u);
  EXPECT_EQ(weights[1], 1);
  const Tensor x = torch::rand({1, 3, 60, 30});
  EXPECT_TRUE(torch::equal(BlurForResize(x, 60), x));
  const Tensor rows = torch::rand({1, 3, 60, 1}).expand({1, 3, 60, 30}).contiguous();
  EXPECT_FALSE(torch::equal(BlurForResize(rows, 20), rows));
  const Tensor columns = torch::rand({1, 3, 1, 30}).expand({1, 3, 60, 30}).contiguous();
  EXPECT_LT(MaxAbsError(BlurForResize(columns, 30), columns), 1e-6);  // the other axis shrinks
}

TEST(OpenClipInput, TheBorderIsMirroredWithoutItsLastPixel) {
  Tensor x = torch::zeros({1, 1, 6, 4});
  x[0][0][1] = 1;  // second row
  const std::vector<double> w = ResizeBlurWeights(6, 3);
  ASSERT_EQ(w.size(), 3u);
  const Tensor y = BlurForResize(x, 3).select(3, 1)[0][0];
  EXPECT_NEAR(y[0].item<float>(), 2 * w[0], 1e-6);
  EXPECT_NEAR(y[1].item<float>(), w[1], 1e-6);
}

TEST(OpenClipInput, CornersStayCornersAndOnlyTheRangeChanges) {
  const Tensor x = 2 * torch::rand({2, 3, 5, 7}) - 1;
  const Tensor mean = torch::tensor({0.48145466f, 0.4578275f, 0.40821073f}).view({1, 3, 1, 1});
  const Tensor deviation = torch::tensor({0.26862954f, 0.26130258f, 0.27577711f}).view({1, 3, 1, 1});
  const Tensor expected = ((x + 1) / 2 - mean) / deviation;
  const Tensor y = PrepareOpenClipInput(x, 20);
  ASSERT_EQ(y.sizes(), at::IntArrayRef({2, 3, 20, 20}));
  const auto corners = [](const Tensor& t) {
    return t.index_select(2, torch::tensor({int64_t{0}, t.size(2) - 1}))
        .index_select(3, torch::tensor({int64_t{0}, t.size(3) - 1}));
  };
  EXPECT_LT(MaxAbsError(corners(y), corners(expected)), 1e-5);
  const Tensor same = 2 * torch::rand({1, 3, 20, 20}) - 1;
  EXPECT_LT(MaxAbsError(PrepareOpenClipInput(same, 20), ((same + 1) / 2 - mean) / deviation), 1e-5);
}

TEST(OpenClipInput, RefusesWhatIsNoImage) {
  EXPECT_THROW(PrepareOpenClipInput(torch::rand({3, 20, 20})), ShapeError);
  EXPECT_THROW(PrepareOpenClipInput(torch::rand({1, 3, 20, 20}, torch::kDouble)), ShapeError);
  EXPECT_THAT(
      [] {
        PrepareOpenClipInput(torch::rand({1, 3, 20, 1}));
      },
      testing::ThrowsMessage<ShapeError>(
          "PrepareOpenClipInput: the images are 1 x 20, expected 2 pixels a side at least"));
}

constexpr const char* kFixture = "openclip_visual_tiny";

OpenClipConfig GoldenConfig(const SafetensorsFile& file) {
  OpenClipConfig config;
  config.width = Count(file, "width");
  config.depth = Count(file, "layers");
  config.heads = Count(file, "heads");
  config.hidden = static_cast<int64_t>(Number(file, "mlp_ratio") * static_cast<double>(config.width));
  config.patch = Count(file, "patch_size");
  config.image_side = Count(file, "image_size");
  config.output = Count(file, "output_dim");
  return config;
}

OpenClip GoldenClip(const SafetensorsFile& file) {
  FileParameters source = GoldenWeights(kFixture);
  OpenClip clip = LoadOpenClip(ParameterScope(source) / "visual", GoldenConfig(file));
  source.Finish();
  return clip;
}

/// max |a - b| <= 1e-4 max |b|
void ExpectNear(const Tensor& actual, const SafetensorsFile& file, const std::string& name) {
  ExpectGolden(actual, file, name, 1e-4 * GoldenTensor(file, name).abs().max().item<double>());
}

class OpenClipParity : public OnThreads {};

TEST_P(OpenClipParity, MatchesTheOfficialEncoder) {
  const SafetensorsFile file = OpenGolden(kFixture);
  const OpenClip clip = GoldenClip(file);
  Tensor x = EmbedPatches(clip, GoldenFloat(file, "inter.preprocessed"));
  ExpectNear(x, file, "inter.ln_pre");
  ExpectNear(AttentionUpdate(clip.blocks[0], x), file, "inter.resblocks.0.attn");
  for (size_t i = 0; i < clip.blocks.size(); ++i) {
    x = Forward(clip.blocks[i], x);
    const std::string name = "inter.resblocks." + std::to_string(i);
    if (file.Has(name)) ExpectNear(x, file, name);
  }
  ExpectNear(Forward(clip, GoldenFloat(file, "inter.preprocessed")), file, "output.embedding");
  const Tensor embeddings = ImageEmbeddings(clip, GoldenFloat(file, "input.image"));
  ExpectNear(embeddings, file, "output.embedding");
  ExpectNear(embeddings.mean(0), file, "output.mean_embedding");
  ExpectNear(ImageEmbeddings(clip, GoldenFloat(file, "input.image_b")), file, "output.embedding_b");
}

INSTANTIATE_TEST_SUITE_P(Threads, OpenClipParity, testing::ValuesIn(ThreadsAndGpu()));

TEST(OpenClip, SameBitsForAnyNumberOfThreads) {
  const SafetensorsFile file = OpenGolden(kFixture);
  OpenClipConfig wide;  // the published sizes, one block
  wide.depth = 1;
  RandomParameters source(5);
  for (const OpenClip& clip : {GoldenClip(file), LoadOpenClip(ParameterScope(source), wide)}) {
    const auto run = [&](int threads) {
      at::set_num_threads(threads);
      return ImageEmbeddings(clip, GoldenFloat(file, "input.image"));
    };
    const int before = at::get_num_threads();
    const Tensor one = run(1), three = run(3);
    at::set_num_threads(before);
    EXPECT_TRUE(torch::equal(one, three));
  }
}

TEST(OpenClip, NamesAndShapesAreThoseOfThePublishedNetwork) {
  ListedParameters parameters;
  LoadOpenClip(ParameterScope(parameters) / "visual", OpenClipConfig());
  const auto expected = GoldenParameterList("openclip_vith14_visual_params.tsv");
  ASSERT_EQ(expected.size(), 392u);
  EXPECT_EQ(parameters.shapes(), expected);
}

/// The weights of the fixture as a file of the whole model: with part of a text half, and without one tensor.
std::filesystem::path WholeModel(const TempDir& dir, const SafetensorsFile& file, const std::string& without = "") {
  std::map<std::string, TensorEntry> tensors;
  for (const auto& [name, entry] : file.tensors()) {
    if (name.starts_with("weights.") && name.substr(8) != without) tensors[name.substr(8)] = entry;
  }
  tensors["transformer.resblocks.0.ln_1.weight"] =
      tensors["logit_scale"] = {"F32", {64}, file.Get("weights.visual.class_embedding").bytes};
  WriteFileAtomically(dir / "clip.safetensors", SerializeSafetensors(tensors, {}));
  return dir / "clip.safetensors";
}

TEST(OpenClip, TheTextHalfIsNotLookedAt) {
  const SafetensorsFile file = OpenGolden(kFixture);
  const TempDir dir;
  const OpenClip clip = LoadOpenClip(WholeModel(dir, file), GoldenConfig(file));
  ExpectNear(ImageEmbeddings(clip, GoldenFloat(file, "input.image_b")), file, "output.embedding_b");
}

TEST(OpenClip, HalfPrecisionStaysNearFloat) {
  const SafetensorsFile file = OpenGolden(kFixture);
  const TempDir dir;
  const OpenClip clip = LoadOpenClip(WholeModel(dir, file), GoldenConfig(file), torch::kCPU, torch::kBFloat16);
  const Tensor embedding = ImageEmbeddings(clip, GoldenFloat(file, "input.image"));
  EXPECT_EQ(clip.projection.scalar_type(), torch::kBFloat16);
  EXPECT_EQ(embedding.scalar_type(), torch::kFloat);
  EXPECT_LT(RelativeL2(embedding, GoldenTensor(file, "output.embedding")), 0.05);
}

TEST(OpenClip, AFileThatDoesNotFitIsRefusedByName) {
  const SafetensorsFile file = OpenGolden(kFixture);
  const TempDir dir;
  EXPECT_THAT([&] { LoadOpenClip(WholeModel(dir, file, "visual.proj"), GoldenConfig(file)); },
              testing::ThrowsMessage<InputError>(testing::AllOf(
                  testing::HasSubstr("clip.safetensors: does not hold the image encoder of OpenCLIP ViT-H-14; "),
                  testing::HasSubstr("missing 1: proj; get"))));
  EXPECT_THAT([] { LoadOpenClip(GoldenDir() / "lpips_tiny.safetensors"); },
              testing::ThrowsMessage<InputError>(testing::HasSubstr("missing 392: ")));
}

TEST(OpenClip, RefusesWhatDoesNotFit) {
  const SafetensorsFile file = OpenGolden(kFixture);
  const OpenClip clip = GoldenClip(file);
  EXPECT_THAT(
      [&] {
        EmbedPatches(clip, torch::rand({1, 3, 448, 224}));
      },
      testing::ThrowsMessage<ShapeError>("EmbedPatches: the images are 224 x 448, expected 224 a side"));
  EXPECT_THROW(EmbedPatches(clip, torch::rand({1, 3, 223, 224})), ShapeError);
  EXPECT_THROW(ImageEmbeddings(clip, torch::rand({3, 40, 40})), ShapeError);
  ListedParameters list;
  EXPECT_THAT([&] { LoadOpenClip(ParameterScope(list), {.width = 60, .heads = 16}); },
              testing::ThrowsMessage<ShapeError>("LoadOpenClip: 16 heads do not divide the width 60"));
  EXPECT_THAT([&] { LoadOpenClip(ParameterScope(list), {.patch = 15}); },
              testing::ThrowsMessage<ShapeError>("LoadOpenClip: patches of 15 do not divide an image of 224"));
}

}  // namespace

}  // namespace oraclegs::seva
