#include "oraclegs/networks/aliked/descriptors.h"

#include "networks/aliked/fixture.h"
#include "oraclegs/core/parallel.h"

namespace oraclegs::aliked {
namespace {

std::vector<Keypoint> GoldenKeypoints(const SafetensorsFile& file) {
  std::vector<Keypoint> keypoints;
  const Tensor places = GoldenTensor(file, "keypoints").to(torch::kFloat);
  for (int64_t i = 0; i < places.size(0); ++i) {
    keypoints.push_back({{places[i][0].item<float>(), places[i][1].item<float>()}, 1});
  }
  return keypoints;
}

TEST(AlikedDescriptors, MatchTheReference) {
  const SafetensorsFile file = OpenGolden(kGolden);
  const Aliked network = GoldenAliked();
  const FeatureMaps maps = GoldenMaps(network, file);
  ExpectGolden(Describe(network.head, maps, GoldenKeypoints(file)), file, "descriptors", 1e-5);
}

TEST(AlikedDescriptors, AreOfUnitLengthAndTheSameBitsOnAnyNumberOfThreads) {
  const SafetensorsFile file = OpenGolden(kGolden);
  const Aliked network = GoldenAliked();
  const FeatureMaps maps = GoldenMaps(network, file);
  // In the corners, where samples lie outside of the image, too.
  std::vector<Keypoint> keypoints = GoldenKeypoints(file);
  for (const float x : {0.f, 89.f}) {
    for (const float y : {0.f, 69.f}) keypoints.push_back({{x, y}, 1});
  }
  const int threads = NumThreads(), torch_threads = at::get_num_threads();
  const auto run = [&](int number) {
    SetNumThreads(number);
    at::set_num_threads(number);
    return Describe(network.head, maps, keypoints);
  };
  const Tensor one = run(1), three = run(3);
  SetNumThreads(threads);
  at::set_num_threads(torch_threads);
  EXPECT_TRUE(torch::equal(one, three));
  EXPECT_LT((one.norm(2, {1}) - 1).abs().max().item<float>(), 1e-5);
}

TEST(AlikedDescriptors, OfNoKeypointsAreNone) {
  const SafetensorsFile file = OpenGolden(kGolden);
  const Aliked network = GoldenAliked();
  EXPECT_EQ(Describe(network.head, GoldenMaps(network, file), {}).sizes(), (std::vector<int64_t>{0, 16}));
}

}  // namespace
}  // namespace oraclegs::aliked
