#pragma once
// Convolutions whose biases are added elsewhere, and sums of maps. For maps with their channels last.

#include "oraclegs/networks/common/layers.h"

namespace oraclegs::seva {

/// The layer without its bias. A GPU's library adds a bias in a pass of its own; a kernel adds it while doing other
/// work.
Conv WithoutBias(const Conv& layer);

/// x + added + a vector for all pixels, [C]. x, added [B, C, h, w] with their channels last; `added` may be undefined.
Tensor SumOfMaps(const Tensor& x, const Tensor& added, const Tensor& vector);

/// Convolution with its bias, which a kernel adds where there is one.
Tensor ConvolveMap(const Conv& layer, const Tensor& x);

}  // namespace oraclegs::seva
