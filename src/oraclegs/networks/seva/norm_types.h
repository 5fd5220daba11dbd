#pragma once
// What the norms and sums of SEVA's UNet take, whether libtorch's operations compute them or kernels of our own.

#include "oraclegs/networks/common/layers.h"

namespace oraclegs::seva {

/// Channels in `groups` of neighbors; each group of each image gets mean 0 and (biased) variance 1, then each channel
/// its own scale and shift.
struct GroupNorm {
  Tensor weight, bias;  ///< [channels]
  int64_t groups = 32;
  double eps = 1e-5;
  bool channels_last = false;  ///< takes maps that lie in memory with their channels last, and gives such maps
};

/// What a residual block does before and after the norm.
struct AroundNorm {
  Tensor offsets;                    ///< [B, channels] is added to x first; undefined: nothing
  const Conv* modulation = nullptr;  ///< gives, from the rays, scale and shift of y (1 + scale) + shift; null: no such
  Tensor rays;                       ///< [B, any, h, w]
};

/// What is added to x [..., C]; undefined: nothing.
struct Addend {
  Tensor rows;     ///< contiguous, as many numbers as x
  Tensor vectors;  ///< [C], or [G, C] or [G, 1, C], each for as many adjacent rows of x
};

}  // namespace oraclegs::seva
