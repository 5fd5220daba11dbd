#pragma once
// Sums along the residual streams of SEVA's UNet, their layer norms, and biases that are added in such sums.

#include "oraclegs/networks/common/layers.h"
#include "oraclegs/networks/seva/norms.h"

namespace oraclegs::seva {

/// Product of the layer. Where kernels take it, its bias is a vector, which is added where the rows are read anyway.
Addend AddendOf(const Linear& layer, const Tensor& x);

/// *x += addend
void Add(const Addend& addend, Tensor* x);
/// x + addend
Tensor Sum(const Tensor& x, const Addend& addend);
/// *x += addend; returns the layer norm of *x.
Tensor NormAfterAdding(const Addend& addend, const LayerNorm& norm, Tensor* x);
/// *sum = x + addend, a new tensor; returns its layer norm.
Tensor NormOfSum(const Tensor& x, const Addend& addend, const LayerNorm& norm, Tensor* sum);

/// The layer without its bias. A GPU's library adds a bias in a pass of its own; a kernel adds it while doing other
/// work.
Conv WithoutBias(const Conv& layer);

/// x + added + a vector for all pixels, [C]. x, added [B, C, h, w] with their channels last; `added` may be undefined.
Tensor SumOfMaps(const Tensor& x, const Tensor& added, const Tensor& vector);

/// Convolution with its bias, which a kernel adds where there is one.
Tensor ConvolveMap(const Conv& layer, const Tensor& x);

}  // namespace oraclegs::seva
