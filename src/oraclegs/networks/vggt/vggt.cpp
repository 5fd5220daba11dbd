#include "oraclegs/networks/vggt/vggt.h"

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

}  // namespace oraclegs::vggt
