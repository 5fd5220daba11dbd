#include "oraclegs/networks/lpips/lpips.h"

#include "networks/fixtures.h"
#include "oraclegs/core/files.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

Lpips GoldenLpips(const SafetensorsFile& file) {
  CheckpointOptions options;
  options.ignored = {"image", "grad_", "per_layer_", "value_"};
  options.device = ParityDevice();
  FileParameters source({GoldenDir() / "lpips_tiny.safetensors"}, options);
  const Lpips lpips = LoadLpips(source, {FeatureNetwork::kVgg16, Counts<5>(file, "channels")});
  source.Finish();
  return lpips;
}

Lpips RandomLpips(FeatureNetwork network) {
  RandomParameters source(41);
  return LoadLpips(source, {network, {4, 6, 8, 10, 12}});
}

Tensor FrameImage(const SafetensorsFile& file, const std::string& name) {
  return GoldenFloat(file, name).permute({1, 2, 0}).contiguous();
}

class LpipsParity : public OnThreads {};

TEST_P(LpipsParity, ValueAndGradientMatchTheReference) {
  const SafetensorsFile file = OpenGolden("lpips_tiny");
  const Lpips lpips = GoldenLpips(file);
  const Tensor image = FrameImage(file, "image0");
  for (const auto& [range, suffix] :
       {std::pair{LpipsRange::kZeroOne, "_zero_1"}, std::pair{LpipsRange::kMinusOneOne, "_minus1_1"}}) {
    const LpipsTarget target = PrepareTarget(lpips, FrameImage(file, "image1"), range);
    Tensor grad = torch::full_like(image, std::nanf(""));
    const LpipsValue value = Distance(lpips, image, target, &grad);
    const double expected = file.Values<double>(std::string("value") + suffix)[0];
    EXPECT_NEAR(value.value, expected, 1e-4 * expected);
    const std::vector<double> layers = file.Values<double>(std::string("per_layer") + suffix);
    for (size_t i = 0; i < 5; ++i) EXPECT_NEAR(value.layers[i], layers[i], 1e-4 * layers[i]) << i;
    const double grad_error =
        RelativeL2(grad.permute({2, 0, 1}), GoldenTensor(file, std::string("grad_image0") + suffix));
    EXPECT_LE(grad_error, 1e-3);
    RecordProperty(std::string("value_relative") + suffix, std::to_string(1e9 * (value.value / expected - 1)) + "e-9");
    RecordProperty(std::string("grad_relative_l2") + suffix, std::to_string(1e9 * grad_error) + "e-9");
  }
}

INSTANTIATE_TEST_SUITE_P(Threads, LpipsParity, testing::ValuesIn(ThreadsAndGpu()));

TEST(Lpips, SameBitsForAnyNumberOfThreads) {
  const Lpips lpips = RandomLpips(FeatureNetwork::kVgg16);
  torch::manual_seed(43);
  const Tensor image = torch::rand({70, 90, 3}), other = torch::rand({70, 90, 3});
  const auto run = [&](int threads) {
    at::set_num_threads(threads);
    Tensor grad = torch::empty_like(image);
    const double value = Distance(lpips, image, PrepareTarget(lpips, other, LpipsRange::kZeroOne), &grad).value;
    return std::pair{value, grad};
  };
  const int before = at::get_num_threads();
  const auto one = run(1), three = run(3);
  at::set_num_threads(before);
  EXPECT_EQ(one.first, three.first);
  EXPECT_TRUE(torch::equal(one.second, three.second));
}

TEST(Lpips, IdenticalImagesHaveNoDistance) {
  for (const FeatureNetwork network : {FeatureNetwork::kVgg16, FeatureNetwork::kAlexNet}) {
    const Lpips lpips = RandomLpips(network);
    const Tensor image = torch::rand({40, 50, 3});
    Tensor grad = torch::full_like(image, 7);
    const LpipsValue value = Distance(lpips, image, PrepareTarget(lpips, image, LpipsRange::kZeroOne), &grad);
    EXPECT_EQ(value.value, 0);
    EXPECT_EQ(grad.abs().max().item<float>(), 0);
  }
}

TEST(Lpips, GradientMatchesCentralDifferences) {
  for (const FeatureNetwork network : {FeatureNetwork::kVgg16, FeatureNetwork::kAlexNet}) {
    Lpips lpips = RandomLpips(network);
    for (FeatureLayer& layer : lpips.features.layers) {  // float64: the step is short, so that few kinks lie on it
      layer.conv.weight = layer.conv.weight.to(torch::kDouble);
      layer.conv.bias = layer.conv.bias.to(torch::kDouble);
    }
    for (Tensor& weight : lpips.weights) weight = weight.to(torch::kDouble);
    torch::manual_seed(42);
    const Tensor image = torch::rand({36, 45, 3}), step = 1e-5 * torch::randn({36, 45, 3});
    const LpipsTarget target = PrepareTarget(lpips, torch::rand({36, 45, 3}), LpipsRange::kMinusOneOne);
    Tensor grad = torch::empty_like(image);
    Distance(lpips, image, target, &grad);
    const Tensor above = image + step, below = image - step;  // as rounded to float32
    const double numeric = Distance(lpips, above, target).value - Distance(lpips, below, target).value;
    const Tensor summands = grad.to(torch::kDouble) * (above.to(torch::kDouble) - below.to(torch::kDouble));
    EXPECT_NEAR(summands.sum().item<double>(), numeric, 1e-3 * summands.norm().item<double>());
  }
}

TEST(Lpips, WhereNoChannelSpeaksTheGradientIsZero) {
  Lpips lpips = RandomLpips(FeatureNetwork::kVgg16);
  const LpipsTarget target = PrepareTarget(lpips, torch::rand({20, 20, 3}), LpipsRange::kZeroOne);
  for (FeatureLayer& layer : lpips.features.layers) layer.conv.bias = torch::full_like(layer.conv.bias, -100);
  const Tensor image = torch::rand({20, 20, 3});
  Tensor grad = torch::full_like(image, 7);
  EXPECT_NE(Distance(lpips, image, target, &grad).value, 0);
  EXPECT_EQ(grad.abs().max().item<float>(), 0);
}

TEST(Lpips, ValueDoesNotDependOnWhetherTheGradientIsAsked) {
  const Lpips lpips = RandomLpips(FeatureNetwork::kAlexNet);
  const Tensor image = torch::rand({40, 40, 3});
  const LpipsTarget target = PrepareTarget(lpips, torch::rand({40, 40, 3}), LpipsRange::kZeroOne);
  Tensor grad = torch::empty_like(image), none;
  const double value = Distance(lpips, image, target, &grad).value;
  EXPECT_EQ(Distance(lpips, image, target, &none).value, value);
  EXPECT_EQ(Distance(lpips, image, target).value, value);
}

TEST(Lpips, TheClassifierOfTorchvisionIsNotRead) {
  // The published sizes, so that names alone are wrong: a file with no tensor but a classifier's.
  const TempDir dir;
  const float zero = 0;
  WriteFileAtomically(
      dir / "vgg16.st",
      SerializeSafetensors({{"classifier.0.weight", {"F32", {1}, {reinterpret_cast<const char*>(&zero), 4}}}}, {}));
  EXPECT_THAT([&] { LoadLpips({dir / "vgg16.st"}, FeatureNetwork::kVgg16); },
              testing::ThrowsMessage<InputError>(testing::AllOf(
                  testing::HasSubstr("vgg16.st: does not hold LPIPS with VGG16; missing 31: features.0.weight, "),
                  testing::Not(testing::HasSubstr("classifier")))));
  EXPECT_THAT([&] { LoadLpips({dir / "vgg16.st"}, FeatureNetwork::kAlexNet); },
              testing::ThrowsMessage<InputError>(testing::HasSubstr("LPIPS with AlexNet; missing 15: ")));
}

TEST(Lpips, RefusesImagesThatDoNotFit) {
  const Lpips lpips = RandomLpips(FeatureNetwork::kVgg16);
  const Tensor image = torch::rand({20, 24, 3});
  const LpipsTarget target = PrepareTarget(lpips, image, LpipsRange::kZeroOne);
  Tensor small = torch::empty({20, 20, 3});
  EXPECT_THROW(Distance(lpips, torch::rand({24, 20, 3}), target), ShapeError);
  EXPECT_THROW(Distance(lpips, image, target, &small), ShapeError);
  EXPECT_THROW(PrepareTarget(lpips, torch::rand({3, 20, 24}), LpipsRange::kZeroOne), ShapeError);
  EXPECT_THROW(PrepareTarget(lpips, torch::rand({15, 24, 3}), LpipsRange::kZeroOne), ShapeError);
}

}  // namespace
}  // namespace oraclegs
