#pragma once
// --set vggt-layers and --set vggt-layer-weights: the layers of VGGT's map (docs/method.md#vggt-oracle).

#include <cstdint>
#include <string>
#include <vector>

#include "oraclegs/validate/options.h"

namespace oraclegs {

/// Layers asked for with their weights, which sum to 1; empty when none are. Throws UsageError naming the option for
/// text that is no whole numbers, a layer named twice, a weight that is no number >= 0, different numbers of layers and
/// weights, and weights that are all 0 or come without layers.
std::vector<LayerWeight> AttentionLayersOf(const ValidateOptions& options);

/// Throws UsageError for a layer that `network`, with layers 0 to depth - 1, does not have.
void RequireAttentionLayers(const std::vector<LayerWeight>& layers, int64_t depth, const std::string& network);

}  // namespace oraclegs
