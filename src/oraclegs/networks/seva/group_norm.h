#pragma once
// Group normalization as Stable Diffusion's networks use it (docs/method.md#seva-group-norm).

#include "oraclegs/networks/seva/norm_types.h"

namespace oraclegs::seva {

/// Throws ShapeError when the groups do not divide the channels.
GroupNorm LoadGroupNorm(const ParameterScope& at, int64_t channels, int64_t groups, double eps);
/// x [B, channels, ...] -> the same shape and type; computed in float32 whatever the type.
Tensor Forward(const GroupNorm& layer, const Tensor& x);
/// y sigmoid(y) with y = Forward(layer, x), without a second copy.
Tensor NormThenSilu(const GroupNorm& layer, const Tensor& x);

/// NormThenSilu with its neighbors in the block. With offsets, x [B, channels, h, w] is undefined afterwards.
Tensor NormThenSilu(const GroupNorm& layer, Tensor x, const AroundNorm& around);

}  // namespace oraclegs::seva
