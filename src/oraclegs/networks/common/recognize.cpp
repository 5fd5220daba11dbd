#include "oraclegs/networks/common/recognize.h"

#include <cmath>
#include <optional>

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr int64_t kHeadWidth = 64;
constexpr int64_t kVggKernel = 3, kAlexNetKernel = 11;

std::string Joined(const std::vector<fs::path>& paths) {
  std::vector<std::string> names;
  for (const fs::path& path : paths) names.push_back(path.string());
  return fmt::format("{}", fmt::join(names, " + "));
}

/// The shape of a tensor that one of the files holds with so many dimensions, all of them positive.
std::optional<std::vector<int64_t>> ShapeOf(const std::vector<SafetensorsFile>& files, const std::string& name,
                                            size_t dimensions) {
  for (const SafetensorsFile& file : files) {
    if (!file.Has(name)) continue;
    const std::vector<int64_t>& shape = file.Get(name).shape;
    bool positive = shape.size() == dimensions;
    for (const int64_t side : shape) positive = positive && side > 0;
    if (positive) return shape;
  }
  return std::nullopt;
}

std::vector<SafetensorsFile> OpenAll(const std::vector<fs::path>& paths) {
  std::vector<SafetensorsFile> files;
  for (const fs::path& path : paths) files.push_back(SafetensorsFile::Open(path));
  return files;
}

}  // namespace

DepthAnythingConfig RecognizeDepthAnything(const fs::path& path) {
  const std::vector<SafetensorsFile> files = OpenAll({path});
  const auto shape = [&](const std::string& name, size_t dimensions) {
    const auto found = ShapeOf(files, name, dimensions);
    if (found) return *found;
    throw InputError("{}: is no Depth Anything V2, it has no {} with {} dimensions; name its official weights",
                     path.string(), name, dimensions);
  };
  DepthAnythingConfig config;
  VitConfig& backbone = config.backbone;
  const std::vector<int64_t> positions = shape("pretrained.pos_embed", 3);
  backbone.width = positions[2];
  backbone.heads = backbone.width / kHeadWidth;
  backbone.position_grid = std::lround(std::sqrt(static_cast<double>(positions[1] - 1)));
  backbone.patch = shape("pretrained.patch_embed.proj.weight", 4)[3];
  backbone.depth = 0;
  while (files[0].Has("pretrained.blocks." + std::to_string(backbone.depth) + ".norm1.weight")) ++backbone.depth;
  const bool is_whole =
      backbone.width % kHeadWidth == 0 && backbone.depth >= 4 && backbone.depth % 4 == 0 && backbone.position_grid > 0;
  if (!is_whole) {
    throw InputError(
        "{}: has {} blocks of width {} with {} positions, which is no Depth Anything V2; name its official weights",
        path.string(), backbone.depth, backbone.width, positions[1]);
  }
  const int64_t quarter = backbone.depth / 4;
  config.layers = {quarter - 1, 2 * quarter - 1, 3 * quarter - 1, 4 * quarter - 1};
  if (backbone.depth == 24) config.layers = DepthAnythingV2(DepthAnythingSize::kLarge).layers;
  config.head.width = backbone.width;
  config.head.patch = backbone.patch;
  config.head.features = shape("depth_head.scratch.output_conv1.weight", 4)[1];
  for (size_t i = 0; i < 4; ++i) {
    config.head.channels[i] = shape("depth_head.projects." + std::to_string(i) + ".weight", 4)[0];
  }
  config.input_side = backbone.position_grid * backbone.patch;
  return config;
}

DepthAnything LoadRecognizedDepthAnything(const fs::path& path, torch::Device device) {
  const DepthAnythingConfig config = RecognizeDepthAnything(path);
  CheckpointOptions options;
  options.model = "Depth Anything V2";
  options.device = device;
  FileParameters source({path}, options);
  DepthAnything model = LoadDepthAnything(source, config);
  source.Finish();
  return model;
}

FeatureStackConfig RecognizeLpips(const std::vector<fs::path>& paths) {
  const std::vector<SafetensorsFile> files = OpenAll(paths);
  const auto shape = [&](const std::string& name) {
    const auto found = ShapeOf(files, name, 4);
    if (found) return *found;
    throw InputError(
        "{}: is no LPIPS, it has no {} with 4 dimensions; name weights that hold its features and lin0 to "
        "lin4",
        Joined(paths), name);
  };
  FeatureStackConfig config;
  const int64_t kernel = shape("features.0.weight")[3];
  if (kernel != kVggKernel && kernel != kAlexNetKernel) {
    throw InputError(
        "{}: its first convolution is {} pixels wide, LPIPS has {} (VGG16) or {} (AlexNet); name its weights",
        Joined(paths), kernel, kVggKernel, kAlexNetKernel);
  }
  config.network = kernel == kVggKernel ? FeatureNetwork::kVgg16 : FeatureNetwork::kAlexNet;
  for (size_t i = 0; i < 5; ++i) config.channels[i] = shape("lin" + std::to_string(i) + ".model.1.weight")[1];
  return config;
}

Lpips LoadRecognizedLpips(const std::vector<fs::path>& paths, torch::Device device) {
  const FeatureStackConfig config = RecognizeLpips(paths);
  CheckpointOptions options;
  options.model = config.network == FeatureNetwork::kVgg16 ? "LPIPS with VGG16" : "LPIPS with AlexNet";
  options.ignored = {"classifier."};
  options.device = device;
  FileParameters source(paths, options);
  Lpips lpips = LoadLpips(source, config);
  source.Finish();
  return lpips;
}

}  // namespace oraclegs
