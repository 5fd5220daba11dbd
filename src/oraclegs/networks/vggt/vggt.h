#pragma once
// VGGT: from images of one scene, in one pass, a camera and a depth map each (docs/method.md#vggt).

#include <array>
#include <optional>

#include "oraclegs/networks/common/dpt.h"
#include "oraclegs/networks/networks.h"
#include "oraclegs/networks/vggt/aggregator.h"
#include "oraclegs/networks/vggt/camera_head.h"

namespace oraclegs::vggt {

/// Defaults are VGGT-1B.
struct Config {
  AggregatorConfig aggregator;
  CameraHeadConfig camera;
  std::array<int64_t, 4> dense_layers = {4, 11, 17, 23};  ///< layers that the depth head reads
  DptConfig dense{.style = DptStyle::kVggt,
                  .width = 2048,
                  .features = 256,
                  .channels = {256, 512, 1024, 1024},
                  .outputs = 2};  ///< outputs: depth and confidence
};

/// Heads that a caller needs; an oracle needs none.
struct Heads {
  bool camera = false, depth = false;
};

struct Vggt {
  Config config;
  Aggregator aggregator;
  std::optional<CameraHead> camera_head;
  std::optional<DptHead> depth_head;
};
Vggt LoadVggt(ParameterSource& source, const Config& config, const Heads& heads);

struct Placement {
  torch::Device device = torch::kCPU;
  torch::ScalarType aggregator_type = torch::kFloat;  ///< type of its weights; the heads are always float32
  std::optional<torch::ScalarType> products =
      {};  ///< type of the aggregator's matrix products; unset = aggregator_type
};
Placement PlaceOn(torch::Device device, VggtPrecision precision);
/// In the usual precision of such a device.
inline Placement PlaceOn(torch::Device device) { return PlaceOn(device, UsualVggtPrecision(device.is_cuda())); }
/// Reads safetensors files with the official names for this configuration. Heads that are not asked for, the point
/// head and the track head may be in the files and are not read. Throws InputError that lists all that does not fit.
Vggt LoadVggt(const std::vector<std::filesystem::path>& paths, const Heads& heads, const Placement& placement = {},
              const Config& config = {});

/// Aggregator layers that the loaded heads read, for AggregatorRequest::token_layers.
std::vector<int64_t> HeadLayers(const Vggt& vggt);

/// Encodings [S, 9] after each iteration of the camera head (CameraEncodings, DecodeCameras).
std::vector<Tensor> PredictCameras(const Vggt& vggt, const AggregatorResult& aggregated);

struct DepthPrediction {
  Tensor depth;       ///< [S, H, W] float32 > 0, along the optical axis
  Tensor confidence;  ///< [S, H, W] float32 >= 1
};
DepthPrediction PredictDepth(const Vggt& vggt, const AggregatorResult& aggregated, const PatchGrid& grid);

// Memory that VGGT needs, known before it starts.

struct Pass {
  int64_t views = 1;
  int64_t height = 518, width = 518;  ///< size of the network's input, pixels
  Heads heads = {};
};

/// Bytes of the tensors that LoadVggt reads for these heads, as float32.
int64_t WeightBytes(const Config& config, const Heads& heads);

/// Peak bytes of a pass on a CPU in float32, beside the weights. For VGGT-1B the pass of the oracle was measured and
/// has a margin; the heads are counted (bench/networks/vggt_bench.cpp).
int64_t PassBytes(const Config& config, const Pass& pass);

}  // namespace oraclegs::vggt
