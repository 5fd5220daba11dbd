#include "oraclegs/networks/lpips/lpips.h"

namespace oraclegs {
namespace {

constexpr double kLengthFloor = 1e-10;
constexpr int64_t kVggKernel = 3, kAlexNetKernel = 11;

Lpips LoadFrom(const std::vector<std::filesystem::path>& paths, const FeatureStackConfig& config,
               torch::Device device) {
  CheckpointOptions options;
  options.model = config.network == FeatureNetwork::kVgg16 ? "LPIPS with VGG16" : "LPIPS with AlexNet";
  options.ignored = {"classifier."};
  options.device = device;
  FileParameters source(paths, options);
  Lpips lpips = LoadLpips(source, config);
  source.Finish();
  return lpips;
}

/// Scaling layer: image [H, W, 3] -> the network's input, [1, 3, H, W].
Tensor NetworkInput(const Lpips& lpips, const Tensor& image, LpipsRange range) {
  const auto options = lpips.weights[0].options();
  const Tensor shift = torch::tensor({-0.030f, -0.088f, -0.188f}).view({1, 3, 1, 1}).to(options);
  const Tensor scale = torch::tensor({0.458f, 0.448f, 0.450f}).view({1, 3, 1, 1}).to(options);
  Tensor x = image.to(options).permute({2, 0, 1}).unsqueeze(0).contiguous();
  if (range == LpipsRange::kMinusOneOne) x = 2 * x - 1;
  return (x - shift) / scale;
}

/// d(network input)/d(image), [1, 1, 3].
Tensor InputSlope(LpipsRange range) {
  const Tensor slope = torch::tensor({0.458f, 0.448f, 0.450f}).reciprocal().view({1, 1, 3});
  return range == LpipsRange::kMinusOneOne ? 2 * slope : slope;
}

/// Length of the feature vector of each pixel, [1, 1, H, W].
Tensor Lengths(const Tensor& features) { return features.square().sum(1, true).sqrt_(); }

/// dL/dF from the gradient of F / (|F| + floor).
Tensor UnitBackward(const Tensor& grad, const Tensor& features, const Tensor& lengths) {
  const Tensor floored = lengths + kLengthFloor;
  const Tensor along = (grad * features).sum(1, true) / (lengths * floored.square());
  return grad / floored - features * along.masked_fill(lengths == 0, 0);
}

}  // namespace

Lpips LoadLpips(ParameterSource& source, const FeatureStackConfig& config) {
  const ParameterScope at(source);
  Lpips lpips;
  lpips.features = LoadFeatureStack(at, config);
  for (size_t i = 0; i < 5; ++i) {
    // A dropout, inactive here, has index 0.
    lpips.weights[i] = (at / ("lin" + std::to_string(i)) / "model" / 1).Get("weight", {1, config.channels[i], 1, 1});
  }
  return lpips;
}

Lpips LoadLpips(const std::vector<std::filesystem::path>& paths, FeatureNetwork network, torch::Device device) {
  return LoadFrom(paths, PublishedFeatures(network), device);
}

FeatureStackConfig RecognizeLpips(const std::vector<std::filesystem::path>& paths) {
  const StoredShapes files(paths);
  const auto shape = [&](const std::string& name) {
    const auto found = files.Find(name, 4);
    if (found) return *found;
    throw InputError(
        "{}: is no LPIPS, it has no {} with 4 dimensions; name weights that hold its features and lin0 to "
        "lin4",
        files.files(), name);
  };
  FeatureStackConfig config;
  const int64_t kernel = shape("features.0.weight")[3];
  if (kernel != kVggKernel && kernel != kAlexNetKernel) {
    throw InputError(
        "{}: its first convolution is {} pixels wide, LPIPS has {} (VGG16) or {} (AlexNet); name its weights",
        files.files(), kernel, kVggKernel, kAlexNetKernel);
  }
  config.network = kernel == kVggKernel ? FeatureNetwork::kVgg16 : FeatureNetwork::kAlexNet;
  for (size_t i = 0; i < 5; ++i) config.channels[i] = shape("lin" + std::to_string(i) + ".model.1.weight")[1];
  return config;
}

Lpips LoadRecognizedLpips(const std::vector<std::filesystem::path>& paths, torch::Device device) {
  return LoadFrom(paths, RecognizeLpips(paths), device);
}

LpipsTarget PrepareTarget(const Lpips& lpips, const Tensor& image, LpipsRange range) {
  RequireFloat("PrepareTarget", "image", image, {-1, -1, 3});
  LpipsTarget target{range, image.size(0), image.size(1), Features(lpips.features, NetworkInput(lpips, image, range))};
  for (Tensor& features : target.features) features = features / (Lengths(features) + kLengthFloor);
  return target;
}

LpipsValue Distance(const Lpips& lpips, const Tensor& image, const LpipsTarget& target, Tensor* grad) {
  RequireFloat("LPIPS", "image", image, {target.height, target.width, 3});
  const bool backward = grad && grad->defined();
  if (backward) RequireFloat("LPIPS", "grad", *grad, {target.height, target.width, 3});
  FeatureTrace trace;
  std::array<Tensor, 5> taps =
      Features(lpips.features, NetworkInput(lpips, image, target.range), backward ? &trace : nullptr);
  LpipsValue out;
  for (size_t i = 0; i < 5; ++i) {
    const Tensor lengths = Lengths(taps[i]);
    const Tensor difference = taps[i] / (lengths + kLengthFloor) - target.features[i];
    const Tensor weighted = difference * lpips.weights[i];
    const double pixels = static_cast<double>(taps[i].size(2) * taps[i].size(3));
    out.layers[i] = (weighted * difference).sum(torch::kDouble).item<double>() / pixels;
    out.value += out.layers[i];
    if (backward) taps[i] = UnitBackward(weighted * (2 / pixels), taps[i], lengths);
  }
  if (backward) {
    const Tensor by_input = FeaturesBackward(lpips.features, trace, taps)[0].permute({1, 2, 0});
    grad->copy_(by_input * InputSlope(target.range).to(by_input.device()));
  }
  return out;
}

}  // namespace oraclegs
