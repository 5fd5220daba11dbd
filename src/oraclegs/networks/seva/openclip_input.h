#pragma once
// Input of the OpenCLIP encoder (docs/method.md#seva-image-encoder).

#include <vector>

#include "oraclegs/networks/common/tensor.h"

namespace oraclegs::seva {

/// images [B, 3, H, W] float32 RGB in [-1, 1], sides >= 2 -> [B, 3, side, side]: stretched, not cropped, then
/// normalized with CLIP's constants. An axis that shrinks is blurred first (BlurForResize); bicubic interpolation
/// (parameter -0.75) with aligned corners follows, not clamped. Throws ShapeError.
Tensor PrepareOpenClipInput(const Tensor& images, int64_t side = 224);

/// Gaussian weights for one axis, with sigma = max((factor - 1) / 2, 0.001) pixels and factor = length / side: an odd
/// number of them, at least 3, about 4 sigma wide, with sum 1.
std::vector<double> ResizeBlurWeights(int64_t length, int64_t side);

/// Blurs both axes, horizontal first, the image mirrored at its border without repeating the last pixel. Returns x [B,
/// C, H, W] itself when no axis shrinks.
Tensor BlurForResize(const Tensor& x, int64_t side);

}  // namespace oraclegs::seva
