#pragma once
// Softmax attention that never holds all scores: queries go through in chunks. With libtorch 2 on a GPU the library's
// fused kernel takes its place.

#include "oraclegs/networks/common/tensor.h"

namespace oraclegs {

/// softmax(q k^T / sqrt(width)) v per batch and head: q [B, heads, Q, width], k, v [B, heads, N, width]
/// -> [B, heads, Q, width]. At most about `max_scores` scores are held at a time (one row at least); 0 chooses for the
/// device. The softmax is in float32 whatever the type. Throws ShapeError.
Tensor Attend(const Tensor& q, const Tensor& k, const Tensor& v, int64_t max_scores = 0);

/// Mean over heads and queries of softmax(q k^T / sqrt(width)): how much attention each key gets. q [heads, Q, width],
/// k [heads, N, width] -> [N] float32, computed in float32 and summed in float64. Throws ShapeError.
Tensor MeanAttention(const Tensor& q, const Tensor& k, int64_t max_scores = 0);

}  // namespace oraclegs
