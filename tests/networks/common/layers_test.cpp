#include "oraclegs/networks/common/layers.h"

#include <ATen/Parallel.h>

#include <cmath>

#include "networks/golden_tensors.h"

namespace oraclegs {
namespace {

TEST(Layers, LinearizXTimesTransposePlusBias) {
  const Linear layer{torch::tensor({{1.f, 2.f}, {3.f, 4.f}, {5.f, 6.f}}), torch::tensor({0.5f, 0.f, -1.f})};
  const Tensor y = Forward(layer, torch::tensor({{{1.f, -1.f}}}));
  EXPECT_TRUE(torch::equal(y, torch::tensor({{{-0.5f, -1.f, -2.f}}})));
}

TEST(Layers, NormHasBiasedVarianceAndItsEpsilon) {
  const LayerNorm layer{torch::tensor({2.f, 2.f}), torch::tensor({1.f, 1.f}), 3};
  // mean 2, variance 1, so (x - 2) / sqrt(1 + 3) * 2 + 1
  EXPECT_TRUE(torch::allclose(Forward(layer, torch::tensor({1.f, 3.f})), torch::tensor({0.f, 2.f})));
}

TEST(Layers, MlpHasTheExactGelu) {
  const Tensor one = torch::ones({1, 1}), zero = torch::zeros({1});
  const double x = 1.3, expected = x * 0.5 * (1 + std::erf(x / std::sqrt(2.0)));
  const Mlp mlp{{one, zero}, {one, zero}};
  EXPECT_NEAR(Forward(mlp, torch::full({1, 1}, x)).item<double>(), expected, 1e-6);
}

TEST(Layers, UpconvPlacesItsKernel) {
  const Upconv layer{torch::arange(4, torch::kFloat).view({1, 1, 2, 2}), torch::ones({1})};
  const Tensor y = Forward(layer, torch::tensor({{{{1.f, 2.f}}}}));
  EXPECT_TRUE(torch::equal(y, torch::tensor({{{{1.f, 2.f, 1.f, 3.f}, {3.f, 4.f, 5.f, 7.f}}}})));
}

TEST(Layers, ConvIsCorrelationWithZerosAround) {
  const Conv conv{torch::arange(9, torch::kFloat).view({1, 1, 3, 3}), {}, 1, 1};
  const Tensor y = Forward(conv, torch::tensor({{{{1.f, 10.f}}}}));
  EXPECT_TRUE(torch::equal(y, torch::tensor({{{{54.f, 43.f}}}})));
}

TEST(Layers, APointwiseConvMixesChannelsOfEachPixel) {
  torch::manual_seed(51);
  const Tensor weight = torch::randn({5, 7, 1, 1}), bias = torch::randn({5}), x = torch::randn({2, 7, 3, 4});
  const Tensor mixed = at::einsum("oc,bchw->bohw", {weight.flatten(1), x});
  EXPECT_LT(MaxAbsError(Forward(Conv{weight, {}, 1, 0}, x), mixed), 1e-6);
  EXPECT_LT(MaxAbsError(Forward(Conv{weight, bias, 1, 0}, x), mixed + bias.view({1, 5, 1, 1})), 1e-6);
  const Tensor last = Forward(Conv{weight, bias, 1, 0, true}, x.contiguous(at::MemoryFormat::ChannelsLast));
  EXPECT_TRUE(HasChannelsLast(last));
  EXPECT_LT(MaxAbsError(last, mixed + bias.view({1, 5, 1, 1})), 1e-6);
}

TEST(Layers, SameBitsForAnyNumberOfThreads) {
  torch::manual_seed(52);
  const Tensor x = torch::randn({1, 256, 37, 30}), tokens = x.flatten(2).transpose(1, 2).contiguous();
  const Conv pointwise{torch::randn({64, 256, 1, 1}), torch::randn({64}), 1, 0};
  const Conv last{torch::randn({1, 256, 1, 1}), torch::randn({1}), 1, 0};
  const Conv wide{torch::randn({32, 256, 3, 3}), torch::randn({32}), 1, 1};
  const Upconv up{torch::randn({256, 256, 2, 2}), torch::randn({256})};
  const Mlp mlp{{torch::randn({512, 256}), torch::randn({512})}, {torch::randn({256, 512}), torch::randn({256})}};
  const auto run = [&](int threads) {
    at::set_num_threads(threads);
    return std::vector<Tensor>{Forward(pointwise, x), Forward(last, x),
                               Forward(wide, x),      Forward(up, x),
                               Forward(mlp, tokens),  ResizeBilinear(x, 50, 61, Corners::kAligned)};
  };
  const int before = at::get_num_threads();
  const std::vector<Tensor> one = run(1), two = run(2), five = run(5);
  at::set_num_threads(before);
  for (size_t i = 0; i < one.size(); ++i) {
    EXPECT_TRUE(torch::equal(one[i], two[i])) << i;
    EXPECT_TRUE(torch::equal(one[i], five[i])) << i;
  }
}

TEST(Layers, BilinearFollowsItsCorners) {
  const Tensor x = torch::tensor({{{{0.f, 3.f}}}});
  EXPECT_TRUE(torch::allclose(ResizeBilinear(x, 1, 4, Corners::kAligned), torch::tensor({{{{0.f, 1.f, 2.f, 3.f}}}})));
  EXPECT_TRUE(
      torch::allclose(ResizeBilinear(x, 1, 4, Corners::kHalfPixel), torch::tensor({{{{0.f, 0.75f, 2.25f, 3.f}}}})));
}

TEST(Layers, RgbIsNormalized) {
  const Tensor mean = torch::tensor({0.485f, 0.456f, 0.406f}).view({1, 3, 1, 1});
  EXPECT_EQ(NormalizeRgb(mean).abs().max().item<float>(), 0);
  EXPECT_NEAR(NormalizeRgb(mean + 0.225)[0][2].item<double>(), 1, 1e-6);
}

TEST(Layers, ImagesOfOtherShapesAreRefused) {
  EXPECT_NO_THROW(RequireImages("test", torch::zeros({1, 3, 28, 14}), 14));
  EXPECT_THROW(RequireImages("test", torch::zeros({1, 3, 28, 15}), 14), ShapeError);
  EXPECT_THROW(RequireImages("test", torch::zeros({1, 4, 28, 14}), 14), ShapeError);
  EXPECT_THROW(RequireImages("test", torch::zeros({3, 28, 14}), 14), ShapeError);
  EXPECT_THROW(RequireImages("test", torch::zeros({0, 3, 28, 14}), 14), ShapeError);
  EXPECT_THROW(RequireImages("test", torch::zeros({1, 3, 28, 14}, torch::kDouble), 14), ShapeError);
  EXPECT_THROW(RequireImages("test", {}, 14), ShapeError);
}

}  // namespace
}  // namespace oraclegs
