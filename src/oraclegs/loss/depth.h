#pragma once

#include "oraclegs/core/tensor.h"

namespace oraclegs {

/// weight * mean(|inv_depth - target| * mask) over all H*W pixels (spec/gaussian_core.md 9). All [H,W] float32.
/// Writes dL/d(inv_depth) into grad (same shape). Returns the weighted loss.
double DepthLoss(const Tensor& inv_depth, const Tensor& target, const Tensor& mask, double weight, Tensor* grad);

}  // namespace oraclegs
