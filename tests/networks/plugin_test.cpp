// The library of networks as a program loads it.

#include <thread>

#include "oraclegs/core/interrupt.h"
#include "oraclegs/networks/loader.h"
#include "oraclegs/scene/loaded_view.h"
#include "support/errors.h"
#include "support/network_files.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// Skips the tests in builds without networks.
class PluginTest : public testing::Test {
 protected:
  void SetUp() override {
    SKIP_WITHOUT_NETWORKS();
    ASSERT_EQ(WhyNoNetworks(), "");
  }
  TempDir dir;
};

TEST_F(PluginTest, IsLoadedOnceFromAnyThread) {
  const Networks* first = nullptr;
  const Networks* second = nullptr;
  std::thread a([&] { first = &GetNetworks(); }), b([&] { second = &GetNetworks(); });
  a.join();
  b.join();
  EXPECT_EQ(first, second);
  EXPECT_EQ(first, &GetNetworks());
}

TEST_F(PluginTest, ErrorsCrossWithTheirType) {
  WriteText(dir / "other.safetensors", "");
  EXPECT_THAT(MessageOf<InputError>([&] { GetNetworks().LoadDepth(dir / "other.safetensors", kCpu); }),
              HasSubstr("other.safetensors"));
}

TEST_F(PluginTest, PredictsDepthAndDistance) {
  const auto depth = GetNetworks().LoadDepth(WriteTinyDepthAnything(dir / "depth.safetensors"), kCpu);
  ImageF image{48, 36, 3, std::vector<float>(48 * 36 * 3)};
  for (size_t i = 0; i < image.data.size(); ++i) image.data[i] = static_cast<float>(i % 251) / 251;
  const Buffer<float> map = depth->InverseDepth(image);
  ASSERT_EQ(map.shape(), (Shape{36, 48}));
  EXPECT_NE(map[0], map[700]);
  const auto lpips = GetNetworks().LoadPerceptual({WriteTinyLpips(dir / "lpips.safetensors")}, kCpu, 1 << 20);
  const Buffer<float> render = Buffer<float>::From({36, 48, 3}, std::span<const float>(image.data));
  const Buffer<float> gray = Buffer<float>::Full({36, 48, 3}, 0.5f);
  Buffer<float> grad = Buffer<float>::Zeros({36, 48, 3});
  EXPECT_GT(lpips->Loss(render, gray, 1, &grad), 0);
  EXPECT_NE(grad[0], 0);
  EXPECT_EQ(lpips->Score(render, render, LpipsRange::kZeroOne), 0);
}

TEST_F(PluginTest, FindsKeypoints) {
  const auto network = GetNetworks().LoadKeypoints(WriteTinyAliked(dir / "aliked.safetensors"), kCpu);
  ImageF image{96, 64, 3, std::vector<float>(96 * 64 * 3)};
  for (size_t i = 0; i < image.data.size(); ++i) image.data[i] = static_cast<float>(i * i % 251) / 251;
  const ImageFeatures features = network->Find(image, {.min_score = 0.01, .max_keypoints = 20});
  ASSERT_EQ(features.keypoints.size(), 20u);
  EXPECT_EQ(features.descriptors.shape(), (Shape{20, network->descriptor_size()}));
  EXPECT_GE(features.scores[0], features.scores[19]);
}

TEST_F(PluginTest, StopsWhenTheProgramIsInterrupted) {
  const auto attention = GetNetworks().OpenAttention(WriteTinyVggt(dir / "vggt.safetensors"), AttentionOptions(), kCpu);
  const Image8 image{28, 28, 3, std::vector<uint8_t>(28 * 28 * 3, 9)};
  EXPECT_EQ(attention->Confidence({image, image}, {1})[0].shape(), (Shape{28, 28}));
  RequestInterrupt(true);
  EXPECT_THROW(attention->Confidence({image, image}, {1}), Interrupted);
  RequestInterrupt(false);
}

TEST_F(PluginTest, GeneratesViews) {
  WriteTinySeva(dir.path());
  const auto file = [&](const char* model) { return dir.path() / model / "model.safetensors"; };
  ViewGeneratorRequest request{{{file("seva")}, file("sd21-vae"), file("openclip-vith14")}, {}, kCpu, int64_t{1} << 40};
  request.options.frames = 4, request.options.short_side = 64, request.options.steps = 1;
  const auto generator = GetNetworks().LoadViewGenerator(request);
  const Camera camera{64, 64, 32, 32, 32, 32, Eigen::Isometry3d::Identity()};
  const std::vector<LoadedView> views = {{"a.jpg", camera, {64, 64, 3, std::vector<float>(64 * 64 * 3, 0.25f)}, {}}};
  ViewRequest wanted;
  wanted.views = &views;
  wanted.targets = {camera};
  int steps = 0;
  const auto images = generator->Generate(
      wanted, [&](const Event& event) { steps += std::holds_alternative<StepDone>(event) ? 1 : 0; });
  EXPECT_EQ(steps, 2) << "one in each pass";
  ASSERT_EQ(images.size(), 1u);
  EXPECT_EQ(images[0][0].width, 64);
}

TEST_F(PluginTest, EstimatesPoses) {
  PoseRequest request;
  request.weights = WriteTinyVggt(dir / "vggt.safetensors");
  for (int i = 0; i < 2; ++i) {
    Image8 image{56, 42, 3, std::vector<uint8_t>(56 * 42 * 3)};
    for (size_t p = 0; p < image.data.size(); ++p) image.data[p] = static_cast<uint8_t>(p * 7 + static_cast<size_t>(i));
    request.images.push_back(std::move(image));
    request.names.push_back(i == 0 ? "a.jpg" : "b.jpg");
  }
  std::vector<std::string> notes;
  const PoseEstimate estimate =
      GetNetworks().EstimatePoses(request, [&](const Event& event) { notes.push_back(std::get<Note>(event).text); });
  EXPECT_EQ(estimate.cameras.size(), 2u);
  EXPECT_EQ(estimate.cameras[0].width, 56);
  EXPECT_THAT(notes, testing::ElementsAre(AllOf(HasSubstr("VGGT looks at 2 photos of"), HasSubstr("GiB"))));
  request.free_bytes = 1;
  EXPECT_THAT(MessageOf<RunError>([&] { GetNetworks().EstimatePoses(request, Silent()); }), HasSubstr("GiB are free"));
}

}  // namespace
}  // namespace oraclegs
