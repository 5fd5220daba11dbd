#pragma once
// Sums along the residual streams of SEVA's UNet, and their layer norms.

#include "oraclegs/networks/seva/norm_types.h"

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

}  // namespace oraclegs::seva
