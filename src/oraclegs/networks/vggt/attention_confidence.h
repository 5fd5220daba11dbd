#pragma once
// From the attention of VGGT's global blocks to the confidence of each pixel (docs/method.md#vggt-oracle).

#include <vector>

#include "oraclegs/networks/common/dpt.h"
#include "oraclegs/networks/networks.h"
#include "oraclegs/networks/vggt/aggregator.h"

namespace oraclegs::vggt {

struct WeightedAttention {
  GlobalAttention attention;
  double weight = 1;
};

/// The queries that a mode reads, and no others.
AttentionQueries QueriesOf(AttentionMode mode);

/// Confidence of each patch: [S, rows, cols] float32 in [0, sum of the weights]; large where the other views attend.
/// Each layer's map is stretched to [0, 1] first; a constant map becomes 0. The attention must have QueriesOf(mode).
/// Throws ShapeError, for kOthers also when there is only one view.
Tensor PatchConfidence(const std::vector<WeightedAttention>& layers, AttentionMode mode, const PatchGrid& grid);

/// [S, rows, cols] -> [S, height, width]: bilinear, half-pixel centers, edges clamped.
Tensor UpsampleConfidence(const Tensor& confidence, int64_t height, int64_t width);

}  // namespace oraclegs::vggt
