#pragma once
// Norms and sums of SEVA's UNet: their types, shared by libtorch's operations and our own kernels (kernels.h), and
// group normalization.

#include "oraclegs/networks/common/layers.h"

namespace oraclegs::seva {

/// Norm over `groups` of neighboring channels; each group of each image gets mean 0 and (biased) variance 1, then each
/// channel its own scale and shift.
struct GroupNorm {
  Tensor weight, bias;  ///< [channels]
  int64_t groups = 32;
  double eps = 1e-5;
  bool channels_last = false;  ///< takes maps that lie in memory with their channels last, and gives such maps
};

/// Operations of a residual block right before and after the norm.
struct AroundNorm {
  Tensor offsets;                    ///< [B, channels], added to x first; undefined = none
  const Conv* modulation = nullptr;  ///< gives, from the rays, scale and shift of y (1 + scale) + shift; null = none
  Tensor rays;                       ///< [B, any, h, w]
};

/// Addend to x [..., C]; undefined = 0.
struct Addend {
  Tensor rows;     ///< contiguous, with as many numbers as x
  Tensor vectors;  ///< [C], or [G, C] or [G, 1, C], each row for as many adjacent rows of x
};

// Group normalization as Stable Diffusion's networks use it (docs/method.md#seva-group-norm).

/// Throws ShapeError when the groups do not divide the channels.
GroupNorm LoadGroupNorm(const ParameterScope& at, int64_t channels, int64_t groups, double eps);
/// x [B, channels, ...] -> the same shape and type; computed in float32 whatever the type.
Tensor Forward(const GroupNorm& layer, const Tensor& x);
/// y sigmoid(y) with y = Forward(layer, x), without a second copy.
Tensor NormThenSilu(const GroupNorm& layer, const Tensor& x);

/// NormThenSilu with its neighbors in the block. With offsets, x [B, channels, h, w] is undefined afterwards.
Tensor NormThenSilu(const GroupNorm& layer, Tensor x, const AroundNorm& around);

}  // namespace oraclegs::seva
