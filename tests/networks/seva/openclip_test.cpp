#include "oraclegs/networks/seva/openclip.h"

#include "networks/fixtures.h"
#include "oraclegs/core/files.h"
#include "support/temp_dir.h"

namespace oraclegs::seva {
namespace {

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
  const auto expected = ParameterList("openclip_vith14_visual_params.tsv");
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
