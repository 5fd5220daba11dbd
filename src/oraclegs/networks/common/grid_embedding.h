#pragma once
// The sinusoidal embedding that VGGT's dense heads add to their maps (docs/method.md#grid-embedding).

#include "oraclegs/networks/common/tensor.h"

namespace oraclegs {

/// [channels, rows, cols] float32. Coordinates depend on `aspect`, width over height of the image, not of the map.
/// Quarters of the channels: sin and cos of x, sin and cos of y. Throws ShapeError unless 4 divides the channels.
Tensor GridEmbedding(int64_t channels, int64_t rows, int64_t cols, double aspect);

}  // namespace oraclegs
