#include "oraclegs/networks/seva/model.h"

#include "networks/seva/tiny_files.h"
#include "support/temp_dir.h"

namespace oraclegs::seva {
namespace {

TEST(SevaModel, GeneratesWithTheNetworksOfItsFiles) {
  const TempDir dir;
  const Model model(MakeTinySeva(dir.path()), {});
  Camera camera;
  camera.width = camera.height = 64;
  camera.fx = camera.fy = camera.cx = camera.cy = 32;
  const std::vector<LoadedView> inputs = {{"a.jpg", camera, {64, 64, 3, std::vector<float>(64 * 64 * 3, 0.25f)}, {}}};
  ViewRequest request;
  request.views = &inputs;
  camera.cam_from_world.translation().x() = 1;
  request.targets = {camera};
  SevaOptions options;
  options.frames = 4;
  options.short_side = 64;
  options.steps = 2;
  const auto images = Generator(model.networks(), options, Silent()).Generate(request);
  ASSERT_EQ(images.size(), 1u);
  const std::vector<float>& data = images[0][0].data;
  EXPECT_EQ(data.size(), 64u * 64 * 3);
  EXPECT_GT(*std::max_element(data.begin(), data.end()), *std::min_element(data.begin(), data.end()));
}

TEST(SevaModel, SaysWhichFileDoesNotFit) {
  const TempDir dir;
  const SevaFiles files = MakeTinySeva(dir.path());
  const auto message = [&](const SevaFiles& wrong) -> std::string {
    try {
      Model(wrong, {});
    } catch (const InputError& error) {
      return error.what();
    }
    return "loaded";
  };
  SevaFiles swapped = files;
  std::swap(swapped.vae, swapped.clip);
  EXPECT_THAT(message(swapped), testing::HasSubstr("does not hold the Stable Diffusion 2.1 autoencoder"));
  KeptParameters source(3);
  OpenClipConfig clip;
  clip.width = 8;
  clip.depth = 1;
  clip.heads = 2;
  clip.hidden = 32;
  clip.patch = 112;
  clip.output = 5;
  LoadOpenClip(ParameterScope(source) / "visual", clip);
  source.Write(files.clip, {{"patch_size", 112}, {"width", 8}, {"layers", 1}, {"heads", 2}, {"output_dim", 5}});
  EXPECT_THAT(message(files), testing::HasSubstr("gives embeddings of 5 numbers"));
  source.Write(files.clip, {{"patch_size", "large"}});
  EXPECT_THAT(message(files), testing::HasSubstr("says that patch_size is '\"large\"'"));
  SevaFiles none = files;
  none.unet.clear();
  EXPECT_THROW(Model(none, {}), ShapeError);
}

TEST(SevaModel, KnowsItsNumberTypes) {
  EXPECT_EQ(PlaceOn(torch::kCPU, Precision::kFloat32).type, torch::kFloat);
  EXPECT_EQ(PlaceOn(torch::kCPU, Precision::kBFloat16).type, torch::kBFloat16);
  EXPECT_EQ(PlaceOn(torch::kCPU, Precision::kFloat16).type, torch::kHalf);
  EXPECT_FALSE(PlaceOn(torch::kCPU, Precision::kFloat16).products);
  EXPECT_EQ(PlaceOn(torch::kCPU, Precision::kAutocast).type, torch::kFloat);
  EXPECT_EQ(PlaceOn(torch::kCPU, Precision::kAutocast).products, torch::kBFloat16);
  EXPECT_EQ(PlaceOn(torch::kCUDA, Precision::kAutocast).products, torch::kHalf);
}

TEST(LoadViewGenerator, GeneratesWhatTheGeneratorDoes) {
  const TempDir dir;
  ViewGeneratorRequest request{MakeTinySeva(dir.path()), {}, kCpu, int64_t{1} << 40};
  request.options.frames = 4;
  request.options.short_side = 64;
  request.options.steps = 1;
  Camera camera;
  camera.width = camera.height = 64;
  camera.fx = camera.fy = camera.cx = camera.cy = 32;
  const std::vector<LoadedView> views = {{"a.jpg", camera, {64, 64, 3, std::vector<float>(64 * 64 * 3, 0.25f)}, {}}};
  ViewRequest wanted;
  wanted.views = &views;
  camera.cam_from_world.translation().x() = 1;
  wanted.targets = {camera};
  const Model model(request.files, {});
  const auto expected = Generator(model.networks(), request.options, Silent()).Generate(wanted);
  EXPECT_EQ(LoadViewGenerator(request)->Generate(wanted, Silent())[0][0].data, expected[0][0].data);
  request.options.steps = 0;
  EXPECT_THROW(LoadViewGenerator(request), UsageError);
}

}  // namespace
}  // namespace oraclegs::seva
