#include "oraclegs/networks/depth_anything/depth_anything.h"

#include <torch/csrc/autograd/autograd.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "oraclegs/networks/common/tensor.h"

namespace oraclegs {
namespace {

const char* Name(DepthAnythingSize size) {
  switch (size) {
    case DepthAnythingSize::kSmall:
      return "Depth Anything V2 S";
    case DepthAnythingSize::kBase:
      return "Depth Anything V2 B";
    case DepthAnythingSize::kLarge:
      return "Depth Anything V2 L";
  }
  return "Depth Anything V2";
}

constexpr int64_t kHeadWidth = 64;

DepthAnything LoadFrom(const std::filesystem::path& path, const char* name, const DepthAnythingConfig& config,
                       torch::Device device) {
  CheckpointOptions options;
  options.model = name;
  options.device = device;
  FileParameters source({path}, options);
  DepthAnything model = LoadDepthAnything(source, config);
  source.Finish();
  return model;
}

class LoadedDepthAnything : public DepthNetwork {
 public:
  explicit LoadedDepthAnything(DepthAnything model) : model_(std::move(model)) {}
  Buffer<float> InverseDepth(const ImageF& rgb) const override {
    const auto pixels = Buffer<float>::From({rgb.height, rgb.width, rgb.channels}, std::span<const float>(rgb.data));
    return BufferOf(RelativeInverseDepth(model_, TensorOf(pixels)));
  }
  Buffer<float> ImageGradient(const Buffer<float>& rgb,
                              const std::function<Buffer<float>(const Buffer<float>&)>& gradient) const override {
    const Tensor image = TensorOf(rgb).detach().requires_grad_(true);
    const Tensor depth = RelativeInverseDepth(model_, image);
    const Tensor of_depth = TensorOf(gradient(BufferOf(depth.detach())));
    return BufferOf(torch::autograd::grad({depth}, {image}, {of_depth})[0].contiguous());
  }

 private:
  DepthAnything model_;
};

/// Multiple of `patch` nearest to `length`, half to even; where that is below `least`, the length is rounded up
/// instead.
int64_t MultipleOf(int64_t patch, double length, int64_t least) {
  const double patches = length / static_cast<double>(patch);
  const int64_t rounded = patch * static_cast<int64_t>(std::nearbyint(patches));
  return rounded >= least ? rounded : patch * static_cast<int64_t>(std::ceil(patches));
}

}  // namespace

DepthAnythingConfig DepthAnythingV2(DepthAnythingSize size) {
  DepthAnythingConfig config;  // the defaults are the small network
  if (size == DepthAnythingSize::kBase) {
    config.backbone.width = config.head.width = 768;
    config.backbone.heads = 12;
    config.head.features = 128;
    config.head.channels = {96, 192, 384, 768};
  } else if (size == DepthAnythingSize::kLarge) {
    config.backbone.width = config.head.width = 1024;
    config.backbone.heads = 16;
    config.backbone.depth = 24;
    config.layers = {4, 11, 17, 23};
    config.head.features = 256;
    config.head.channels = {256, 512, 1024, 1024};
  }
  return config;
}

DepthAnything LoadDepthAnything(ParameterSource& source, const DepthAnythingConfig& config) {
  const ParameterScope at(source);
  return {config, LoadVit(at / "pretrained", config.backbone), LoadDptHead(at / "depth_head", config.head)};
}

DepthAnything LoadDepthAnything(const std::filesystem::path& path, DepthAnythingSize size, torch::Device device) {
  return LoadFrom(path, Name(size), DepthAnythingV2(size), device);
}

DepthAnythingConfig RecognizeDepthAnything(const std::filesystem::path& path) {
  const StoredShapes files({path});
  const auto shape = [&](const std::string& name, size_t dimensions) {
    const auto found = files.Find(name, dimensions);
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
  while (files.Has("pretrained.blocks." + std::to_string(backbone.depth) + ".norm1.weight")) ++backbone.depth;
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

DepthAnything LoadRecognizedDepthAnything(const std::filesystem::path& path, torch::Device device) {
  return LoadFrom(path, "Depth Anything V2", RecognizeDepthAnything(path), device);
}

std::unique_ptr<DepthNetwork> LoadDepthNetwork(const std::filesystem::path& path, torch::Device device) {
  return std::make_unique<LoadedDepthAnything>(LoadRecognizedDepthAnything(path, device));
}

Tensor ResizeForDepthAnything(const Tensor& rgb, int64_t side, int64_t patch) {
  RequireFloat("ResizeForDepthAnything", "rgb", rgb, {-1, -1, 3});
  const int64_t height = rgb.size(0), width = rgb.size(1);
  if (height < 1 || width < 1) throw ShapeError("ResizeForDepthAnything: the photo has no pixel");
  // The smaller side becomes `side` exactly: s * side need not, and its ceiling would then be a patch too much.
  const double scale = static_cast<double>(side) / static_cast<double>(std::min(width, height));
  const auto target = [&](int64_t length) {
    const double scaled =
        length == std::min(width, height) ? static_cast<double>(side) : scale * static_cast<double>(length);
    return MultipleOf(patch, scaled, side);
  };
  const Tensor planes = rgb.permute({2, 0, 1}).unsqueeze(0).contiguous();
  return at::upsample_bicubic2d(planes, {target(height), target(width)}, false);
}

std::array<Tensor, 4> HeadLayers(const DepthAnything& model, const Tensor& normalized) {
  const std::vector<Tensor> tokens =
      LayerTokens(model.backbone, normalized, {model.config.layers.begin(), model.config.layers.end()});
  std::array<Tensor, 4> patches;
  for (size_t i = 0; i < 4; ++i) patches[i] = tokens[i].slice(1, model.backbone.special_tokens());
  return patches;
}

Tensor Forward(const DepthAnything& model, const Tensor& normalized) {
  const std::array<Tensor, 4> layers = HeadLayers(model, normalized);
  const int64_t patch = model.config.backbone.patch;
  const Tensor raw = Forward(model.head, layers, {normalized.size(2) / patch, normalized.size(3) / patch});
  return at::relu(raw.select(1, 0).to(torch::kFloat));
}

Tensor RelativeInverseDepth(const DepthAnything& model, const Tensor& rgb) {
  const Tensor input = NormalizeRgb(ResizeForDepthAnything(rgb, model.config.input_side, model.config.backbone.patch));
  const Tensor map = Forward(model, input.to(model.backbone.class_token.device())).to(torch::kCPU).unsqueeze(0);
  return ResizeBilinear(map, rgb.size(0), rgb.size(1), Corners::kAligned)[0][0].contiguous();
}

}  // namespace oraclegs
