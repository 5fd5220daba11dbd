#pragma once
// --vggt-layers and --vggt-layer-weights: which layers make VGGT's map (docs/method.md#vggt-oracle).

#include <cstdint>
#include <string>
#include <vector>

#include "oraclegs/validate/options.h"

namespace oraclegs {

/// The layers asked for with their weights, which sum to 1; empty when none are. Throws UsageError naming the option:
/// no whole numbers, a layer twice, a weight that is no number >= 0, other counts of layers and weights, weights that
/// are all 0 or stand without layers.
std::vector<LayerWeight> AttentionLayersOf(const ValidateOptions& options);

/// Throws UsageError when a layer is asked for that `network`, with layers 0 to depth - 1, does not have.
void RequireAttentionLayers(const std::vector<LayerWeight>& layers, int64_t depth, const std::string& network);

}  // namespace oraclegs
