#include "oraclegs/networks/seva/generator.h"

#include <algorithm>
#include <set>

#include "networks/seva/tiny_seva.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/parallel.h"
#include "support/temp_dir.h"

namespace oraclegs::seva {
namespace {

Camera CameraAt(double angle, int width, int height) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = width;
  camera.cx = width / 2.0;
  camera.cy = height / 2.0;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()).toRotationMatrix();
  pose.translation() = pose.linear() * Eigen::Vector3d(0, 0, -3);
  camera.cam_from_world = pose.inverse();
  return camera;
}

/// Two input images of 100 x 70 and three targets on an arc, at the smallest size that seva works at.
struct TinyScene {
  std::vector<LoadedView> inputs;
  SevaOptions options;
  ViewRequest request;
  Unet unet = TinyUnet();

  TinyScene() {
    for (int i = 0; i < 2; ++i) {
      LoadedView photo;
      photo.name = fmt::format("{}.jpg", i);
      photo.camera = CameraAt(0.4 * i, 100, 70);
      photo.rgb = {100, 70, 3, std::vector<float>(100 * 70 * 3)};
      for (size_t p = 0; p < photo.rgb.data.size(); ++p) {
        photo.rgb.data[p] = static_cast<float>((p * 37 + static_cast<size_t>(i) * 11) % 256) / 255;
      }
      inputs.push_back(std::move(photo));
    }
    for (int i = 0; i < 3; ++i) request.targets.push_back(CameraAt(0.1 + 0.3 * i, 100, 70));
    request.views = &inputs;
    request.key = "scene";
    options.frames = 4;
    options.short_side = 64;
    options.steps = 2;
  }
  std::vector<std::vector<ImageF>> Generate(const Listener& listener = Silent()) const {
    return Generator(TinyNetworkSet(unet), options, listener).Generate(request);
  }
};

TEST(SevaGenerator, MakesEveryTargetAtItsCamerasSize) {
  TinyScene scene;
  scene.options.candidates = 2;
  const auto images = scene.Generate();
  ASSERT_EQ(images.size(), 3u);
  for (const auto& candidates : images) {
    ASSERT_EQ(candidates.size(), 2u);
    for (const ImageF& image : candidates) {
      EXPECT_EQ(image.width, 100);
      EXPECT_EQ(image.height, 70);
      EXPECT_EQ(image.channels, 3);
      EXPECT_EQ(image.data.size(), 100u * 70 * 3);
      const auto [low, high] = std::minmax_element(image.data.begin(), image.data.end());
      EXPECT_GE(*low, 0);
      EXPECT_LE(*high, 1);
    }
    EXPECT_NE(candidates[0].data, candidates[1].data);
  }
}

TEST(SevaGenerator, SameBitsForAnyNumberOfThreadsAndOthersForAnotherSeed) {
  TinyScene scene;
  const auto run = [&](int threads) {
    SetNumThreads(threads);
    at::set_num_threads(threads);
    return scene.Generate();
  };
  const int before = NumThreads(), torch_before = at::get_num_threads();
  const auto one = run(1), three = run(3);
  SetNumThreads(before);
  at::set_num_threads(torch_before);
  for (size_t t = 0; t < one.size(); ++t) EXPECT_EQ(one[t][0].data, three[t][0].data) << t;
  scene.options.seed = 24;
  EXPECT_NE(scene.Generate()[0][0].data, one[0][0].data);
}

TEST(SevaGenerator, GoesOnBehindTheLastFinishedChunk) {
  const TempDir dir;
  TinyScene scene;
  const auto expected = scene.Generate();
  scene.request.workspace = dir / "seva";
  int64_t total = 0, steps = 0;
  const auto count = [&](const Event& event) {
    const auto* step = std::get_if<StepDone>(&event);
    if (!step) return;
    EXPECT_EQ(step->stage, "propose");
    EXPECT_EQ(step->unit, "denoising steps");
    EXPECT_EQ(step->done, ++steps);
    total = step->total;
  };
  // The first chunk has two steps: the third belongs to the second.
  EXPECT_THROW(scene.Generate([&](const Event& event) {
    count(event);
    if (steps == 3) RequestInterrupt(true);
  }),
               Interrupted);
  RequestInterrupt(false);
  const int64_t all_steps = total;
  steps = 0;
  const auto resumed = scene.Generate(count);
  EXPECT_EQ(total, all_steps - 2);
  EXPECT_EQ(steps, all_steps - 2);
  for (size_t t = 0; t < expected.size(); ++t) EXPECT_EQ(resumed[t][0].data, expected[t][0].data);
  steps = 0;
  scene.Generate(count);
  EXPECT_EQ(steps, 0);
  scene.options.candidates = 2;  // the first is there
  scene.Generate(count);
  EXPECT_EQ(steps, all_steps);
  steps = 0;
  scene.options.cfg = 2;
  scene.options.candidates = 1;
  scene.Generate(count);
  EXPECT_EQ(steps, all_steps);
}

TEST(SevaGenerator, PlacesTheNetworksInTurn) {
  TinyScene scene;
  scene.options.frames = 8;
  std::vector<Component> components;
  NetworkSet networks = TinyNetworkSet(scene.unet);
  networks.place = [&](Component component) { components.push_back(component); };
  Generator(networks, scene.options, Silent()).Generate(scene.request);
  EXPECT_EQ(components, (std::vector<Component>{Component::kEncoder, Component::kUnet, Component::kDecoder,
                                                Component::kEncoder, Component::kUnet, Component::kDecoder}));
}

TEST(SevaGenerator, EncodesEveryImageOnce) {
  TinyScene scene;
  scene.options.candidates = 3;
  int encoded = 0;
  NetworkSet networks = TinyNetworkSet(scene.unet);
  networks.encode = [&, encode = networks.encode](const Tensor& image) {
    ++encoded;
    return encode(image);
  };
  Generator(networks, scene.options, Silent()).Generate(scene.request);
  EXPECT_EQ(encoded, 2) << "the photos once, for all candidates";
}

TEST(SevaGenerator, DecodesInTilesWhereMemoryIsShort) {
  TinyScene scene;
  scene.options.steps = 1;
  scene.request.targets.resize(1);
  std::vector<std::string> warnings;
  std::set<int64_t> sides;
  NetworkSet networks = TinyNetworkSet(scene.unet);
  networks.decode = [&, decode = networks.decode](const Tensor& latent, int64_t side) {
    sides.insert(side);
    return decode(latent, side);
  };
  const auto generate = [&] {
    sides.clear();
    Generator(networks, scene.options, [&](const Event& event) {
      if (const auto* warning = std::get_if<Warning>(&event)) warnings.push_back(warning->text);
    }).Generate(scene.request);
  };
  generate();
  EXPECT_THAT(sides, testing::ElementsAre(8));
  EXPECT_TRUE(warnings.empty());
  scene.options.short_side = 256;  // images of 384 x 256, latents of 48 x 32
  networks.free_bytes = int64_t{1} << 30;
  networks.autoencoder.tile = networks.free_bytes / (40 * 32);
  generate();
  EXPECT_THAT(sides, testing::ElementsAre(32));
  EXPECT_THAT(warnings, testing::ElementsAre(testing::HasSubstr("decoded in tiles of 256 pixels")));
}

TEST(SevaGenerator, RefusesWhatItCannotDo) {
  TinyScene scene;
  NetworkSet networks = TinyNetworkSet(scene.unet);
  networks.free_bytes = 1000;
  EXPECT_THROW(Generator(networks, scene.options, Silent()).Generate(scene.request), RunError);
  networks.decode = {};
  EXPECT_THROW(Generator(networks, scene.options, Silent()), ShapeError);
  scene.inputs[1].camera = CameraAt(0.4, 70, 100);
  scene.inputs[1].rgb.width = 70;
  scene.inputs[1].rgb.height = 100;
  scene.options.short_side = 128;
  try {
    scene.Generate();
    FAIL() << "generated";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("1.jpg: seva would work on 128 x 192 pixels"));
  }
  scene.inputs.clear();
  EXPECT_THROW(scene.Generate(), ShapeError);
  scene.options.steps = 0;
  EXPECT_THROW(scene.Generate(), UsageError);
}

TEST(SevaGenerator, ImagesAndTensorsAreTheSame) {
  ImageF image{2, 1, 3, {0, 0.25f, 0.5f, 0.75f, 1, 0.125f}};
  const Tensor tensor = ToNetworkImage(image);
  EXPECT_EQ(tensor.sizes(), (at::IntArrayRef{1, 3, 1, 2}));
  EXPECT_EQ(tensor[0][1][0][0].item<float>(), -0.5f);
  EXPECT_EQ(FromNetworkImage(tensor).data, image.data);
}

}  // namespace
}  // namespace oraclegs::seva
