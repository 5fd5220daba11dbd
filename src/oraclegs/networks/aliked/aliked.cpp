#include "oraclegs/networks/aliked/aliked.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "oraclegs/networks/common/tensor.h"

namespace oraclegs::aliked {
namespace {

/// Names of tensors that a file holds beside weights when it was converted without the name of its network.
std::vector<std::string> NamesOfCounters() {
  std::vector<std::string> names;
  for (int block = 1; block <= 4; ++block) {
    for (int norm = 1; norm <= 2; ++norm) names.push_back(fmt::format("block{}.bn{}.num_batches_tracked", block, norm));
  }
  return names;
}

class LoadedAliked : public KeypointNetwork {
 public:
  explicit LoadedAliked(Aliked network) : network_(std::move(network)) {}

  int64_t descriptor_size() const override { return network_.head.config.descriptor_size(); }

  ImageFeatures Find(const ImageF& rgb, const KeypointOptions& options) const override {
    const double side = std::max(rgb.width, rgb.height);
    const double scale = std::min(1.0, static_cast<double>(options.max_side) / side);
    const auto scaled = [&](int length) { return std::max(1, static_cast<int>(std::lround(scale * length))); };
    const ImageF reduced = scale < 1 ? ResizeArea(rgb, scaled(rgb.width), scaled(rgb.height)) : rgb;
    const auto pixels =
        Buffer<float>::From({reduced.height, reduced.width, reduced.channels}, std::span<const float>(reduced.data));
    ImageFeatures features = FindFeatures(network_, TensorOf(pixels), options);
    const Eigen::Vector2f back(static_cast<float>(rgb.width) / static_cast<float>(reduced.width),
                               static_cast<float>(rgb.height) / static_cast<float>(reduced.height));
    for (Eigen::Vector2f& keypoint : features.keypoints) keypoint = keypoint.cwiseProduct(back);
    return features;
  }

 private:
  Aliked network_;
};

}  // namespace

Aliked LoadAliked(ParameterSource& source, const AlikedConfig& config) {
  const ParameterScope at(source);
  return {LoadEncoder(at, config), LoadDescriptorHead(at / "desc_head", config)};
}

AlikedConfig RecognizeAliked(const std::filesystem::path& path) {
  const StoredShapes files({path});
  const auto shape = [&](const std::string& name, size_t dimensions) {
    const auto found = files.Find(name, dimensions);
    if (found) return *found;
    throw InputError("{}: is no ALIKED, it has no {} with {} dimensions; `oraclegs models fetch aliked-n16` brings one",
                     path.string(), name, dimensions);
  };
  AlikedConfig config;
  config.widths = {shape("block1.conv2.weight", 4)[0], shape("block2.conv2.weight", 4)[0],
                   shape("block3.conv2.regular_conv.weight", 4)[0], shape("block4.conv2.regular_conv.weight", 4)[0]};
  config.samples = shape("desc_head.agg_weights", 3)[0];
  if (config.descriptor_size() % 4 != 0) {
    throw InputError(
        "{}: is no ALIKED, its descriptors have {} numbers, which four maps cannot share; name its official "
        "weights",
        path.string(), config.descriptor_size());
  }
  return config;
}

Aliked LoadRecognizedAliked(const std::filesystem::path& path, torch::Device device) {
  const AlikedConfig config = RecognizeAliked(path);
  CheckpointOptions options;
  options.model = "ALIKED";
  options.ignored = NamesOfCounters();
  options.device = device;
  FileParameters source({path}, options);
  Aliked network = LoadAliked(source, config);
  source.Finish();
  return network;
}

ImageFeatures FindFeatures(const Aliked& network, const Tensor& rgb, const KeypointOptions& options) {
  const FeatureMaps maps = Forward(network.encoder, rgb.to(network.head.sample_weights.device()));
  const std::vector<Keypoint> keypoints = FindKeypoints(maps.scores.to(torch::kCPU), options);
  ImageFeatures features;
  for (const Keypoint& keypoint : keypoints) {
    features.keypoints.push_back(keypoint.place + Eigen::Vector2f::Constant(0.5f));
    features.scores.push_back(keypoint.score);
  }
  features.descriptors = BufferOf(Describe(network.head, maps, keypoints));
  return features;
}

std::unique_ptr<KeypointNetwork> LoadKeypointNetwork(const std::filesystem::path& path, torch::Device device) {
  return std::make_unique<LoadedAliked>(LoadRecognizedAliked(path, device));
}

}  // namespace oraclegs::aliked
