#pragma once

#include "oraclegs/core/tensor.h"

namespace oraclegs {

/// weight * mean(|rendered - target| * mask) over all H*W pixels: the depth term, of inverse depths
/// (spec/gaussian_core.md 9), and the alpha term. All [H,W] float32; an undefined mask is 1 everywhere. Writes
/// dL/d(rendered) into grad (same shape), which may be null or undefined. Returns the weighted loss. Throws ShapeError.
double MaskedL1(const Tensor& rendered, const Tensor& target, const Tensor& mask, double weight, Tensor* grad);

}  // namespace oraclegs
