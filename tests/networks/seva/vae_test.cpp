#include "oraclegs/networks/seva/vae.h"

#include "networks/seva/vae_fixture.h"
#include "oraclegs/core/files.h"
#include "support/temp_dir.h"

namespace oraclegs::seva {
namespace {

class VaeParity : public OnThreads {};

TEST_P(VaeParity, EncodesAsTheOfficialNetwork) {
  const SafetensorsFile file = OpenGolden(kVaeFixture);
  const Vae vae = GoldenVae(file);
  const Tensor image = GoldenFloat(file, "input.image"), small = GoldenFloat(file, "input.small_factor");
  const Tensor moments = LatentMoments(vae, image);
  ExpectGoldenVae(moments, file, "output.moments");
  ExpectGoldenVae(moments.slice(1, 0, vae.config.latent_channels), file, "output.encode_mean");
  ExpectGoldenVae(EncodeImages(vae, image), file, "output.encode_scaled");
  ExpectGoldenVae(LatentMoments(vae, image * small), file, "output.moments_small");
}

TEST_P(VaeParity, DecodesAsTheOfficialNetwork) {
  const SafetensorsFile file = OpenGolden(kVaeFixture);
  const Vae vae = GoldenVae(file);
  const Tensor latent = GoldenFloat(file, "input.latent");
  ExpectGoldenVae(DecodeLevels(vae.decoder, DecodeMiddle(vae.decoder, latent)), file, "output.decode");
  ExpectGoldenVae(DecodeLatents(vae, latent), file, "output.decode_scaled");
}

INSTANTIATE_TEST_SUITE_P(Threads, VaeParity, testing::ValuesIn(ThreadsAndGpu()));

/// Few layers with the published network's widths where sums are longest.
Vae WideVae() {
  VaeConfig config;
  config.channels = {128, 512};
  config.resnets = 1;
  RandomParameters source(7);
  return LoadVae(source, config);
}

TEST(Vae, SameBitsForAnyNumberOfThreads) {
  const SafetensorsFile file = OpenGolden(kVaeFixture);
  for (const Vae& vae : {GoldenVae(file), WideVae()}) {
    const auto run = [&](int threads) {
      at::set_num_threads(threads);
      return std::pair{EncodeImages(vae, GoldenFloat(file, "input.image")),
                       DecodeLatents(vae, GoldenFloat(file, "input.latent"))};
    };
    const int before = at::get_num_threads();
    const auto one = run(1), three = run(3);
    at::set_num_threads(before);
    EXPECT_TRUE(torch::equal(one.first, three.first));
    EXPECT_TRUE(torch::equal(one.second, three.second));
  }
}

TEST(Vae, AnImageDoesNotDependOnItsBatch) {
  const SafetensorsFile file = OpenGolden(kVaeFixture);
  const Vae vae = GoldenVae(file);
  const Tensor images = GoldenFloat(file, "input.image"), latents = GoldenFloat(file, "input.latent");
  EXPECT_TRUE(torch::equal(EncodeImages(vae, images)[1], EncodeImages(vae, images.slice(0, 1, 2))[0]));
  EXPECT_TRUE(torch::equal(DecodeLatents(vae, latents)[1], DecodeLatents(vae, latents.slice(0, 1, 2))[0]));
}

TEST(Vae, NamesAndShapesAreThoseOfThePublishedNetwork) {
  ListedParameters parameters;
  const Vae vae = LoadVae(parameters, VaeConfig());
  const auto expected = GoldenParameterList("sd21_vae_params.tsv");
  ASSERT_EQ(expected.size(), 248u);
  EXPECT_EQ(parameters.shapes(), expected);
  EXPECT_EQ(vae.config.downscale(), 8);
}

/// The weights of the fixture in a file of their own, each name and shape as `edit` leaves it.
template <class F>
std::filesystem::path Rewritten(const TempDir& dir, const SafetensorsFile& file, F&& edit) {
  std::map<std::string, TensorEntry> tensors;
  for (const auto& [stored, entry] : file.tensors()) {
    if (!stored.starts_with("weights.")) continue;
    std::string name = stored.substr(8);
    TensorEntry tensor = entry;
    edit(name, tensor.shape);
    tensors[name] = tensor;
  }
  WriteFileAtomically(dir / "vae.safetensors", SerializeSafetensors(tensors, {}));
  return dir / "vae.safetensors";
}

TEST(Vae, FilesWithTheOlderNamesOfTheAttentionAreUnderstood) {
  const SafetensorsFile file = OpenGolden(kVaeFixture);
  const TempDir dir;
  int renamed = 0;
  const auto path = Rewritten(dir, file, [&](std::string& name, std::vector<int64_t>& shape) {
    for (const auto& [older, current] : {std::pair{"query", "to_q"}, std::pair{"key", "to_k"},
                                         std::pair{"value", "to_v"}, std::pair{"proj_attn", "to_out.0"}}) {
      const size_t place = name.find(std::string(".attentions.0.") + current + ".");
      if (place == std::string::npos) continue;
      name.replace(place + 14, std::string(current).size(), older);
      if (shape.size() == 2) shape.insert(shape.end(), {1, 1});
      ++renamed;
    }
  });
  ASSERT_EQ(renamed, 16);
  const Vae vae = LoadVae(path, GoldenVaeConfig(file));
  ExpectGoldenVae(DecodeLatents(vae, GoldenFloat(file, "input.latent")), file, "output.decode_scaled");
}

TEST(Vae, OneErrorListsWhatIsMissingTooMuchAndOfAnotherShape) {
  const SafetensorsFile file = OpenGolden(kVaeFixture);
  const TempDir dir;
  const auto path = Rewritten(dir, file, [](std::string& name, std::vector<int64_t>& shape) {
    if (name == "quant_conv.bias") name = "quant_conv.offset";
    if (name == "post_quant_conv.weight") shape = {4, 2, 2, 1};
  });
  EXPECT_THAT([&] { LoadVae(path, GoldenVaeConfig(file)); },
              testing::ThrowsMessage<InputError>(testing::AllOf(
                  testing::HasSubstr("vae.safetensors: does not hold the Stable Diffusion 2.1 autoencoder; "),
                  testing::HasSubstr("missing 1: quant_conv.bias; "),
                  testing::HasSubstr("post_quant_conv.weight is [4, 2, 2, 1], expected [4, 4, 1, 1]"))));
  EXPECT_THAT([&] { LoadVae(path); }, testing::ThrowsMessage<InputError>(testing::HasSubstr("missing ")));
}

TEST(Vae, HalfPrecisionStaysNearFloat) {
  const SafetensorsFile file = OpenGolden(kVaeFixture);
  const TempDir dir;
  const auto path = Rewritten(dir, file, [](std::string&, std::vector<int64_t>&) {});
  const Vae half = LoadVae(path, GoldenVaeConfig(file), torch::kCPU, torch::kBFloat16);
  EXPECT_EQ(half.decoder.conv_in.weight.scalar_type(), torch::kBFloat16);
  const Tensor image = DecodeLatents(half, GoldenFloat(file, "input.latent"));
  EXPECT_EQ(image.scalar_type(), torch::kFloat);
  EXPECT_LT(RelativeL2(image, GoldenTensor(file, "output.decode_scaled")), kMaxHalfError);
  const Tensor latent = EncodeImages(half, GoldenFloat(file, "input.image"));
  EXPECT_EQ(latent.scalar_type(), torch::kFloat);
  EXPECT_LT(RelativeL2(latent, GoldenTensor(file, "output.encode_scaled")), kMaxHalfError);
}

TEST(Vae, RefusesWhatDoesNotFit) {
  const SafetensorsFile file = OpenGolden(kVaeFixture);
  const Vae vae = GoldenVae(file);
  EXPECT_THAT(
      [&] {
        EncodeImages(vae, torch::rand({1, 3, 16, 18}));
      },
      testing::ThrowsMessage<ShapeError>(testing::HasSubstr("LatentMoments: the images are [1, 3, 16, 18] Float, "
                                                            "expected float32 [any, 3, H, W] with H and W "
                                                            "multiples of 4")));
  EXPECT_THAT(
      [&] {
        DecodeLatents(vae, torch::rand({1, 3, 8, 8}));
      },
      testing::ThrowsMessage<ShapeError>(
          "DecodeLatents: the latents are [1, 3, 8, 8] Float, expected float32 [any, 4, h, w]"));
  EXPECT_THAT([&] { DecodeLatents(vae, Tensor()); },
              testing::ThrowsMessage<ShapeError>("DecodeLatents: the latents are undefined"));
  EXPECT_THROW(DecodeLatents(vae, torch::rand({0, 4, 8, 8})), ShapeError);
  EXPECT_THROW(DecodeLatents(vae, torch::rand({1, 4, 8, 8}, torch::kDouble)), ShapeError);
  ListedParameters list;
  VaeConfig config;
  config.channels.clear();
  EXPECT_THAT([&] { LoadVae(list, config); },
              testing::ThrowsMessage<ShapeError>("LoadVae: the autoencoder has no levels"));
}

}  // namespace
}  // namespace oraclegs::seva
