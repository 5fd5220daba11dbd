#pragma once
// Group normalisation as Stable Diffusion's networks use it (docs/method.md#seva-group-norm).

#include "oraclegs/networks/common/layers.h"

namespace oraclegs::seva {

/// Channels in `groups` of neighbours; each group of each image gets mean 0 and (biased) variance 1, then each channel
/// its own scale and shift.
struct GroupNorm {
  Tensor weight, bias;  ///< [channels]
  int64_t groups = 32;
  double eps = 1e-5;
  bool channels_last = false;  ///< takes maps that lie in memory with their channels last, and gives such maps
};
/// Throws ShapeError when the groups do not divide the channels.
GroupNorm LoadGroupNorm(const ParameterScope& at, int64_t channels, int64_t groups, double eps);
/// x [B, channels, ...] -> the same shape and type; computed in float32 whatever the type, but with channels_last:
/// there sums alone are.
Tensor Forward(const GroupNorm& layer, const Tensor& x);
/// y sigmoid(y) of the above, with no second copy of it.
Tensor NormThenSilu(const GroupNorm& layer, const Tensor& x);

}  // namespace oraclegs::seva
