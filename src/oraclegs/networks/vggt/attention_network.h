#pragma once
// The aggregator behind the program's interface: how much the views of a scene attend to each other's pixels
// (docs/method.md#vggt-oracle).

#include <memory>

#include "oraclegs/networks/vggt/attention_confidence.h"
#include "oraclegs/networks/vggt/vggt.h"
#include "oraclegs/networks/vggt/weights_file.h"

namespace oraclegs::vggt {

/// Settings of an attention network, beside its weights.
struct AttentionSettings {
  AttentionMode mode = AttentionMode::kReference;
  int64_t side = 518;  ///< longer side of the network's input, pixels
  std::vector<int64_t> layers = {0, 22};
  std::vector<double> weights = {0.25, 0.75};  ///< weight of each layer
};

/// Maps [height, width] float32 in [0, 1] as AttentionNetwork::Confidence returns them. Throws ShapeError also when
/// layers and weights differ in number.
std::vector<Tensor> AttentionOn(const Aggregator& aggregator, const AttentionSettings& settings,
                                const std::vector<Image8>& views, const std::vector<size_t>& asked);

/// Uses the layers and weights asked for, else those that the file names; weights are scaled to sum to 1. Throws
/// InputError as ReadWeightsFile does and naming a layer that the network does not have; ShapeError for weights below 0
/// or without a sum.
std::unique_ptr<AttentionNetwork> OpenAttention(const std::filesystem::path& weights, const AttentionOptions& options,
                                                torch::Device device);

}  // namespace oraclegs::vggt
