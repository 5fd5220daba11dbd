#pragma once

#include "oraclegs/core/buffer.h"

namespace oraclegs {

/// weight * mean(|rendered - target| * mask) over all H*W pixels: the depth term, of inverse depths
/// (docs/method.md#depth-term), and the alpha term. All [H,W] float32; an undefined mask is 1 everywhere. Writes
/// dL/d(rendered) into grad (same shape), which may be null or undefined. Returns the weighted loss. Throws ShapeError.
double MaskedL1(const Buffer<float>& rendered, const Buffer<float>& target, const Buffer<float>& mask, double weight,
                Buffer<float>* grad);

}  // namespace oraclegs
