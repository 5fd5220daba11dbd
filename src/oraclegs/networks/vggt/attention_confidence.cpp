#include "oraclegs/networks/vggt/attention_confidence.h"

namespace oraclegs::vggt {
namespace {

constexpr double kMinRange = 1e-12;  // attention is of the order of 1 / tokens, so this must be smaller

/// Attention that each patch receives, [S, P] float64.
Tensor AttentionReceived(const GlobalAttention& attention, AttentionMode mode) {
  if (mode == AttentionMode::kOfficial) return attention.from_camera[0].to(torch::kDouble);
  const Tensor from = attention.from_patches.to(torch::kDouble);
  if (mode == AttentionMode::kReference) return from[0];
  const Tensor own = from.diagonal(0, 0, 1).t();  // [S, P]
  return (from.sum(0) - own) / static_cast<double>(from.size(0) - 1);
}

/// The attention that the mode reads, [Q, S, P].
const Tensor& ReadBy(AttentionMode mode, const GlobalAttention& attention) {
  return mode == AttentionMode::kOfficial ? attention.from_camera : attention.from_patches;
}

}  // namespace

AttentionQueries QueriesOf(AttentionMode mode) {
  const bool camera = mode == AttentionMode::kOfficial;
  return {mode == AttentionMode::kOthers ? 0 : 1, !camera, camera};
}

Tensor PatchConfidence(const std::vector<WeightedAttention>& layers, AttentionMode mode, const PatchGrid& grid) {
  if (layers.empty()) throw ShapeError("PatchConfidence: there are no layers");
  Tensor sum;
  for (const WeightedAttention& layer : layers) {
    const Tensor& from = ReadBy(mode, layer.attention);
    if (!from.defined() || from.dim() != 3 || from.size(2) != grid.rows * grid.cols ||
        (mode == AttentionMode::kOthers && from.size(0) != from.size(1))) {
      throw ShapeError("PatchConfidence: the attention is [{}], expected {} x [S, {}]",
                       from.defined() ? fmt::format("{}", fmt::join(from.sizes(), ", ")) : "missing", Word(mode),
                       grid.rows * grid.cols);
    }
    if (mode == AttentionMode::kOthers && from.size(1) < 2) {
      throw ShapeError("PatchConfidence: one view has no others to look at it");
    }
    const Tensor map = AttentionReceived(layer.attention, mode);
    const bool together = mode == AttentionMode::kOfficial;
    const Tensor low = together ? map.min() : map.amin({1}, true), high = together ? map.max() : map.amax({1}, true);
    const Tensor stretched = (map - low) / (high - low).clamp_min(kMinRange) * layer.weight;
    sum = sum.defined() ? sum + stretched : stretched;
  }
  return sum.view({sum.size(0), grid.rows, grid.cols}).to(torch::kFloat);
}

Tensor UpsampleConfidence(const Tensor& confidence, int64_t height, int64_t width) {
  if (confidence.dim() != 3) {
    throw ShapeError("UpsampleConfidence: the map is [{}], expected [S, rows, cols]",
                     fmt::join(confidence.sizes(), ", "));
  }
  return ResizeBilinear(confidence.unsqueeze(1), height, width, Corners::kHalfPixel).squeeze(1);
}

}  // namespace oraclegs::vggt
