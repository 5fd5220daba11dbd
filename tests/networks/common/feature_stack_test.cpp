#include "oraclegs/networks/common/feature_stack.h"

#include "networks/golden_tensors.h"

namespace oraclegs {
namespace {

FeatureStack RandomStack(FeatureNetwork network, const std::array<int64_t, 5>& channels) {
  RandomParameters source(31);
  return LoadFeatureStack(ParameterScope(source), {network, channels});
}

TEST(FeatureStack, Vgg16HasTorchvisionsNamesAndShapes) {
  ListedParameters list;
  LoadFeatureStack(ParameterScope(list), PublishedFeatures(FeatureNetwork::kVgg16));
  const std::vector<std::array<int64_t, 3>> convs = {
      {0, 3, 64},     {2, 64, 64},    {5, 64, 128},   {7, 128, 128},  {10, 128, 256}, {12, 256, 256}, {14, 256, 256},
      {17, 256, 512}, {19, 512, 512}, {21, 512, 512}, {24, 512, 512}, {26, 512, 512}, {28, 512, 512}};
  std::map<std::string, std::vector<int64_t>> expected;
  for (const auto& [index, in, out] : convs) {
    expected["features." + std::to_string(index) + ".weight"] = {out, in, 3, 3};
    expected["features." + std::to_string(index) + ".bias"] = {out};
  }
  EXPECT_EQ(list.shapes(), expected);
}

TEST(FeatureStack, AlexNetHasTorchvisionsNamesAndShapes) {
  ListedParameters list;
  LoadFeatureStack(ParameterScope(list), PublishedFeatures(FeatureNetwork::kAlexNet));
  const std::map<std::string, std::vector<int64_t>> expected = {
      {"features.0.weight", {64, 3, 11, 11}},
      {"features.0.bias", {64}},
      {"features.3.weight", {192, 64, 5, 5}},
      {"features.3.bias", {192}},
      {"features.6.bias", {384}},
      {"features.6.weight", {384, 192, 3, 3}},
      {"features.8.weight", {256, 384, 3, 3}},
      {"features.8.bias", {256}},
      {"features.10.bias", {256}},
      {"features.10.weight", {256, 256, 3, 3}},
  };
  EXPECT_EQ(list.shapes(), expected);
}

TEST(FeatureStack, TapsHaveTheSizesOfThePublishedNetworks) {
  const auto sizes = [](FeatureNetwork network, const Tensor& x) {
    std::vector<std::vector<int64_t>> out;
    for (const Tensor& tap : Features(RandomStack(network, {2, 3, 4, 5, 6}), x)) out.push_back(tap.sizes().vec());
    return out;
  };
  EXPECT_EQ(
      sizes(FeatureNetwork::kVgg16, torch::rand({1, 3, 35, 48})),
      (std::vector<std::vector<int64_t>>{{1, 2, 35, 48}, {1, 3, 17, 24}, {1, 4, 8, 12}, {1, 5, 4, 6}, {1, 6, 2, 3}}));
  EXPECT_EQ(
      sizes(FeatureNetwork::kAlexNet, torch::rand({1, 3, 64, 80})),
      (std::vector<std::vector<int64_t>>{{1, 2, 15, 19}, {1, 3, 7, 9}, {1, 4, 3, 4}, {1, 5, 3, 4}, {1, 6, 3, 4}}));
}

TEST(FeatureStack, BackwardMatchesCentralDifferences) {
  for (const FeatureNetwork network : {FeatureNetwork::kVgg16, FeatureNetwork::kAlexNet}) {
    FeatureStack stack = RandomStack(network, {4, 5, 6, 7, 8});
    for (FeatureLayer& layer : stack.layers) {  // float64, so that differences are exact enough
      layer.conv.weight = layer.conv.weight.to(torch::kDouble);
      layer.conv.bias = layer.conv.bias.to(torch::kDouble);
    }
    torch::manual_seed(32);
    const Tensor x = torch::rand({1, 3, 40, 47}, torch::kDouble),
                 direction = torch::randn({1, 3, 40, 47}, torch::kDouble);
    FeatureTrace trace;
    std::array<Tensor, 5> grad_taps = Features(stack, x, &trace);
    for (Tensor& grad : grad_taps) grad = torch::randn(grad.sizes(), torch::kDouble);
    const double analytic = (FeaturesBackward(stack, trace, grad_taps) * direction).sum().item<double>();
    const auto loss = [&](double step) {
      const std::array<Tensor, 5> taps = Features(stack, x + step * direction);
      double sum = 0;
      for (size_t i = 0; i < 5; ++i) sum += (taps[i] * grad_taps[i]).sum().item<double>();
      return sum;
    };
    const double numeric = (loss(1e-7) - loss(-1e-7)) / 2e-7;
    EXPECT_NEAR(analytic, numeric, 1e-4 * std::abs(numeric) + 1e-5);
  }
}

TEST(FeatureStack, RefusesImagesThatVanishInIt) {
  const FeatureStack vgg = RandomStack(FeatureNetwork::kVgg16, {2, 2, 2, 2, 2});
  EXPECT_EQ(Features(vgg, torch::rand({1, 3, 16, 16}))[4].numel(), 2);
  EXPECT_THROW(Features(vgg, torch::rand({1, 3, 15, 40})), ShapeError);
  EXPECT_THROW(Features(vgg, torch::rand({1, 1, 16, 16})), ShapeError);
  const FeatureStack alex = RandomStack(FeatureNetwork::kAlexNet, {2, 2, 2, 2, 2});
  EXPECT_EQ(Features(alex, torch::rand({1, 3, 31, 31}))[4].numel(), 2);
  EXPECT_THROW(Features(alex, torch::rand({1, 3, 40, 30})), ShapeError);
}

}  // namespace
}  // namespace oraclegs
