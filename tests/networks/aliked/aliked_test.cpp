#include "oraclegs/networks/aliked/aliked.h"

#include "networks/aliked/fixture.h"
#include "networks/network_files.h"
#include "support/errors.h"
#include "support/temp_dir.h"

namespace oraclegs::aliked {
namespace {

using testing::AllOf;
using testing::HasSubstr;

ImageF Noise(int width, int height) {
  ImageF image{width, height, 3, std::vector<float>(static_cast<size_t>(width) * static_cast<size_t>(height) * 3)};
  torch::manual_seed(6);
  const Tensor values = torch::rand({static_cast<int64_t>(image.data.size())});
  std::copy_n(values.data_ptr<float>(), image.data.size(), image.data.begin());
  return image;
}

class AlikedFileTest : public testing::Test {
 protected:
  TempDir dir;
};

class AlikedParity : public OnThreads {};

TEST_P(AlikedParity, FeaturesMatchTheReference) {
  const SafetensorsFile file = OpenGolden(kGolden);
  const Aliked network = GoldenAliked();
  const ImageFeatures features =
      FindFeatures(network, GoldenFloat(file, "image"),
                   {.min_score = Number(file, "threshold"), .max_keypoints = Count(file, "limit")});
  const Tensor places = GoldenTensor(file, "keypoints");
  ASSERT_EQ(static_cast<int64_t>(features.keypoints.size()), places.size(0));
  for (int64_t i = 0; i < places.size(0); ++i) {
    const Eigen::Vector2f& keypoint = features.keypoints[static_cast<size_t>(i)];
    EXPECT_NEAR(keypoint.x() - 0.5, places[i][0].item<float>(), 2e-3) << i;
    EXPECT_NEAR(keypoint.y() - 0.5, places[i][1].item<float>(), 2e-3) << i;
  }
  const Tensor descriptors =
      torch::tensor(std::vector<float>(features.descriptors.span().begin(), features.descriptors.span().end()))
          .view({places.size(0), 16});
  ExpectGolden(descriptors, file, "descriptors", 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Threads, AlikedParity, testing::ValuesIn(ThreadsAndGpu()));

TEST_F(AlikedFileTest, LoadsWhatItRecognizes) {
  const auto path = MakeTinyAliked(dir / "aliked.safetensors");
  const AlikedConfig config = RecognizeAliked(path);
  EXPECT_EQ(config.widths, (std::array<int64_t, 4>{4, 8, 12, 16}));
  EXPECT_EQ(config.samples, 4);
  const auto network = LoadKeypointNetwork(path, torch::kCPU);
  EXPECT_EQ(network->descriptor_size(), 16);
}

TEST_F(AlikedFileTest, KeypointsAreInPixelsOfTheImageThatWasReduced) {
  const auto network = LoadKeypointNetwork(MakeTinyAliked(dir / "aliked.safetensors"), torch::kCPU);
  const ImageF small = Noise(80, 60);
  const ImageFeatures whole = network->Find(small, {.min_score = 0.01});
  ASSERT_GT(whole.keypoints.size(), 10u);
  EXPECT_EQ(whole.descriptors.shape(), (Shape{static_cast<int64_t>(whole.keypoints.size()), 16}));
  const ImageF large = [&] {  // each pixel four times: reduced, it is the small one
    ImageF image{160, 120, 3, std::vector<float>(160 * 120 * 3)};
    for (int y = 0; y < 120; ++y) {
      for (int x = 0; x < 160; ++x) std::copy_n(small.row(y / 2) + x / 2 * 3, 3, image.row(y) + x * 3);
    }
    return image;
  }();
  const ImageFeatures reduced = network->Find(large, {.min_score = 0.01, .max_side = 80});
  ASSERT_EQ(reduced.keypoints.size(), whole.keypoints.size());
  for (size_t i = 0; i < whole.keypoints.size(); ++i) {
    EXPECT_LT((reduced.keypoints[i] - 2 * whole.keypoints[i]).norm(), 1e-2) << i;
  }
}

TEST_F(AlikedFileTest, FlatImagesAreNoError) {
  const auto network = LoadKeypointNetwork(MakeTinyAliked(dir / "aliked.safetensors"), torch::kCPU);
  const ImageF flat{64, 48, 3, std::vector<float>(64 * 48 * 3, 0.5f)};
  const ImageFeatures features = network->Find(flat, {.min_score = 0.99});
  EXPECT_TRUE(features.keypoints.empty());
  EXPECT_EQ(features.descriptors.shape(), (Shape{0, 16}));
}

TEST_F(AlikedFileTest, SaysWhatIsWrongWithAnotherFile) {
  const auto lpips = MakeTinyLpips(dir / "lpips.safetensors");
  EXPECT_THAT(MessageOf<InputError>([&] { RecognizeAliked(lpips); }),
              AllOf(HasSubstr("lpips.safetensors: is no ALIKED"), HasSubstr("no block1.conv2.weight"),
                    HasSubstr("models fetch aliked-n16")));
  KeptParameters parameters(1);
  LoadAliked(parameters, {{4, 8, 12, 16}, 4});
  parameters.Get("conv3.weight", {4, 11, 1, 1});
  const auto path = parameters.Write(dir / "other.safetensors");
  EXPECT_THAT(MessageOf<InputError>([&] { LoadRecognizedAliked(path); }),
              AllOf(HasSubstr("does not hold ALIKED; of another shape"),
                    HasSubstr("conv3.weight is [4, 11, 1, 1], expected [4, 12, 1, 1]")));
}

}  // namespace
}  // namespace oraclegs::aliked
