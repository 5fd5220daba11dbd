#include "oraclegs/networks/vggt/vggt.h"

#include <algorithm>
#include <set>

namespace oraclegs::vggt {
namespace {

const Tensor& TokensOf(const AggregatorResult& aggregated, int64_t layer) {
  const auto it = aggregated.tokens.find(layer);
  if (it == aggregated.tokens.end()) throw ShapeError("VGGT: the tokens of layer {} were not kept", layer);
  return it->second;
}

template <class Head>
const Head& Loaded(const std::optional<Head>& head, const char* name) {
  if (!head) throw ShapeError("VGGT: the {} head is not loaded", name);
  return *head;
}

constexpr int64_t kFloat = 4;
// Widths a token inside a block: its input, queries, keys and values before and after norm and rotation, and their
// copies for the product; or the wide layer of the MLP with its input and output. The input of the frame block stays.
constexpr int64_t kWidthsInBlock = 16;
constexpr int64_t kWidthsKept = 2;                   // for a layer that the heads read
constexpr int64_t kBytesOnTop = int64_t{256} << 20;  // scores in work, buffers of the libraries

/// Bytes of the depth head, which works view by view: maps of 8x the grid with all features, then of the image's size
/// with half of them, with the unrolled input of a convolution.
int64_t DenseBytes(const Config& config, const Pass& pass) {
  const int64_t patch = config.aggregator.backbone.patch, features = config.dense.features;
  const int64_t fine = 64 * (pass.height / patch) * (pass.width / patch), pixels = pass.height * pass.width;
  const int64_t fusing = 5 * features * fine, shown = 5 * (features / 2) * pixels;
  return kFloat * (std::max(fusing, shown) + 4 * pass.views * pixels);
}

}  // namespace

Vggt LoadVggt(ParameterSource& source, const Config& config, const Heads& heads) {
  const ParameterScope at(source);
  Vggt vggt;
  vggt.config = config;
  vggt.aggregator = LoadAggregator(at / "aggregator", config.aggregator);
  if (heads.camera) vggt.camera_head = LoadCameraHead(at / "camera_head", config.camera);
  if (heads.depth) vggt.depth_head = LoadDptHead(at / "depth_head", config.dense);
  return vggt;
}

Vggt LoadVggt(const std::vector<std::filesystem::path>& paths, const Heads& heads, const Placement& placement,
              const Config& config) {
  CheckpointOptions options;
  options.model = "VGGT-1B";
  options.ignored = {"point_head.", "track_head."};
  if (!heads.camera) options.ignored.push_back("camera_head.");
  if (!heads.depth) options.ignored.push_back("depth_head.");
  options.device = placement.device;
  options.cast_type = placement.aggregator_type;
  options.cast_prefix = "aggregator.";
  FileParameters source(paths, options);
  Vggt vggt = LoadVggt(source, config, heads);
  vggt.aggregator.products = placement.products;
  source.Finish();
  return vggt;
}

Placement PlaceOn(torch::Device device, VggtPrecision precision) {
  switch (precision) {
    case VggtPrecision::kBFloat16:
      return {device, torch::kBFloat16, {}};
    case VggtPrecision::kAutocast:
      return {device, torch::kFloat, torch::kBFloat16};
    case VggtPrecision::kFloat32:
      break;
  }
  return {device, torch::kFloat, {}};
}

std::vector<int64_t> HeadLayers(const Vggt& vggt) {
  std::set<int64_t> layers;
  if (vggt.camera_head) layers.insert(vggt.config.aggregator.depth - 1);
  if (vggt.depth_head) layers.insert(vggt.config.dense_layers.begin(), vggt.config.dense_layers.end());
  return {layers.begin(), layers.end()};
}

std::vector<Tensor> PredictCameras(const Vggt& vggt, const AggregatorResult& aggregated) {
  const CameraHead& head = Loaded(vggt.camera_head, "camera");
  return CameraEncodings(head, TokensOf(aggregated, vggt.config.aggregator.depth - 1).select(1, 0));
}

DepthPrediction PredictDepth(const Vggt& vggt, const AggregatorResult& aggregated, const PatchGrid& grid) {
  const DptHead& head = Loaded(vggt.depth_head, "depth");
  std::array<Tensor, 4> layers;
  for (size_t i = 0; i < 4; ++i) {
    layers[i] = TokensOf(aggregated, vggt.config.dense_layers[i]).slice(1, vggt.aggregator.special_tokens());
  }
  const Tensor raw = Forward(head, layers, grid).to(torch::kFloat);
  return {raw.select(1, 0).exp(), raw.select(1, 1).exp().add_(1)};
}

int64_t WeightBytes(const Config& config, const Heads& heads) {
  ListedParameters list;
  LoadVggt(list, config, heads);
  int64_t numbers = 0;
  for (const auto& [name, shape] : list.shapes()) {
    int64_t size = 1;
    for (const int64_t n : shape) size *= n;
    numbers += size;
  }
  return kFloat * numbers;
}

int64_t PassBytes(const Config& config, const Pass& pass) {
  const int64_t patch = config.aggregator.backbone.patch;
  const int64_t patches = (pass.height / patch) * (pass.width / patch);
  const int64_t tokens = pass.views * (1 + config.aggregator.registers + patches);
  const int64_t row = kFloat * tokens * config.aggregator.width();
  const int64_t block = kWidthsInBlock * row;
  const int64_t kept = (pass.heads.depth ? 4 : pass.heads.camera ? 1 : 0) * kWidthsKept * row;
  const int64_t images = 3 * kFloat * 3 * pass.views * pass.height * pass.width;
  return kept + images + std::max(block, pass.heads.depth ? DenseBytes(config, pass) : 0) + kBytesOnTop;
}

}  // namespace oraclegs::vggt
