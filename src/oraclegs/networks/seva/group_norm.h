#pragma once
// Group normalization as Stable Diffusion's networks use it (docs/method.md#seva-group-norm).

#include "oraclegs/networks/seva/norm_types.h"

namespace oraclegs::seva {

/// Throws ShapeError when the groups do not divide the channels.
GroupNorm LoadGroupNorm(const ParameterScope& at, int64_t channels, int64_t groups, double eps);
/// x [B, channels, ...] -> the same shape and type; computed in float32 whatever the type.
Tensor Forward(const GroupNorm& layer, const Tensor& x);
/// y sigmoid(y) of the above, with no second copy of it.
Tensor NormThenSilu(const GroupNorm& layer, const Tensor& x);

/// NormThenSilu with what is around it. x [B, channels, h, w] may hold anything afterwards where there are offsets.
Tensor NormThenSilu(const GroupNorm& layer, Tensor x, const AroundNorm& around);

}  // namespace oraclegs::seva
