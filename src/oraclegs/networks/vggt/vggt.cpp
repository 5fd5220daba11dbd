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

/// Output of a dense head, [S, outputs, H, W].
Tensor DenseOutput(const Vggt& vggt, const DptHead& head, const AggregatorResult& aggregated, const PatchGrid& grid) {
  std::array<Tensor, 4> layers;
  for (size_t i = 0; i < 4; ++i) {
    layers[i] = TokensOf(aggregated, vggt.config.dense_layers[i]).slice(1, vggt.aggregator.special_tokens());
  }
  return Forward(head, layers, grid).to(torch::kFloat);
}

Tensor Confidence(const Tensor& raw) { return raw.exp().add_(1); }

}  // namespace

Vggt LoadVggt(ParameterSource& source, const Config& config, const Heads& heads) {
  const ParameterScope at(source);
  Vggt vggt;
  vggt.config = config;
  vggt.aggregator = LoadAggregator(at / "aggregator", config.aggregator);
  if (heads.camera) vggt.camera_head = LoadCameraHead(at / "camera_head", config.camera);
  if (heads.depth) vggt.depth_head = LoadDptHead(at / "depth_head", config.dense);
  if (heads.points) {
    DptConfig points = config.dense;
    points.outputs += 2;  // three coordinates in place of one depth
    vggt.point_head = LoadDptHead(at / "point_head", points);
  }
  return vggt;
}

Vggt LoadVggt(const std::vector<std::filesystem::path>& paths, const Heads& heads, const Placement& placement,
              const Config& config) {
  CheckpointOptions options;
  options.model = "VGGT-1B";
  options.ignored = {"track_head."};
  if (!heads.camera) options.ignored.push_back("camera_head.");
  if (!heads.depth) options.ignored.push_back("depth_head.");
  if (!heads.points) options.ignored.push_back("point_head.");
  options.device = placement.device;
  options.cast_type = placement.aggregator_type;
  options.cast_prefix = "aggregator.";
  FileParameters source(paths, options);
  Vggt vggt = LoadVggt(source, config, heads);
  vggt.aggregator.products = placement.products;
  source.Finish();
  return vggt;
}

Placement PlaceOn(torch::Device device, const Auto<VggtPrecision>& precision) {
  const VggtPrecision usual = device.is_cuda() ? VggtPrecision::kBFloat16 : VggtPrecision::kFloat32;
  switch (precision.ValueOr(usual)) {
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
  if (vggt.depth_head || vggt.point_head) {
    layers.insert(vggt.config.dense_layers.begin(), vggt.config.dense_layers.end());
  }
  return {layers.begin(), layers.end()};
}

std::vector<Tensor> PredictCameras(const Vggt& vggt, const AggregatorResult& aggregated) {
  const CameraHead& head = Loaded(vggt.camera_head, "camera");
  return CameraEncodings(head, TokensOf(aggregated, vggt.config.aggregator.depth - 1).select(1, 0));
}

DepthPrediction PredictDepth(const Vggt& vggt, const AggregatorResult& aggregated, const PatchGrid& grid) {
  const Tensor raw = DenseOutput(vggt, Loaded(vggt.depth_head, "depth"), aggregated, grid);
  return {raw.select(1, 0).exp(), Confidence(raw.select(1, 1))};
}

PointPrediction PredictPoints(const Vggt& vggt, const AggregatorResult& aggregated, const PatchGrid& grid) {
  const Tensor raw = DenseOutput(vggt, Loaded(vggt.point_head, "point"), aggregated, grid);
  const Tensor inverse_log = raw.slice(1, 0, 3).permute({0, 2, 3, 1});
  return {inverse_log.sign() * inverse_log.abs().expm1(), Confidence(raw.select(1, 3))};
}

}  // namespace oraclegs::vggt
