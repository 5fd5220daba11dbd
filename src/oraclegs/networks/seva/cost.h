#pragma once
// Operations of a step of SEVA, so that a measured time can be compared with the machine's peak
// (docs/method.md#seva-cost-and-memory).

#include "oraclegs/networks/seva/unet.h"

namespace oraclegs::seva {

/// Operations (a multiply-add is two) of one evaluation of both halves of guidance: linear layers, convolutions and
/// attention as the published network has them. (With one context token we skip a few per cent of it.)
struct Cost {
  double total = 0;
  double joint_attention = 0;  ///< share of the total: scores and values where all frames attend to each other
};
/// `unet` may have no memory (ListedParameters); latents of `height` x `width`.
Cost CostOfStep(const Unet& unet, int64_t frames, int64_t height, int64_t width);

}  // namespace oraclegs::seva
