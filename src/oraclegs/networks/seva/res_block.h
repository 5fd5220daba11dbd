#pragma once
// The residual block of SEVA's UNet (docs/method.md#seva-residual-block): two convolutions, the first modulated by the
// camera rays of each pixel, with the time embedding added between.

#include <optional>

#include "oraclegs/networks/seva/norms.h"

namespace oraclegs::seva {

struct ResShape {
  int64_t in = 0, out = 0;
  int64_t embedding = 0;  ///< width of the time embedding
  int64_t dense = 6;      ///< channels of the dense map
  int64_t groups = 32;
};

struct ResBlock {
  GroupNorm norm_in, norm_out;
  Conv conv_in, conv_out;
  Linear embedding;
  Conv dense;                ///< 1x1; scale and shift for each input channel
  std::optional<Conv> skip;  ///< 1x1, where the number of channels changes
};
ResBlock LoadResBlock(const ParameterScope& at, const ResShape& shape);

/// x [N, in, h, w], embedding [N, width] (after its SiLU), dense [N, 6, h, w] at the size of x -> [N, out, h, w].
Tensor Forward(const ResBlock& block, const Tensor& x, const Tensor& embedding, const Tensor& dense);

}  // namespace oraclegs::seva
