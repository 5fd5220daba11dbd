#include "oraclegs/networks/seva/openclip_input.h"

#include <cmath>

#include "networks/fixtures.h"

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

}  // namespace
}  // namespace oraclegs::seva
