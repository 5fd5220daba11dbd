#pragma once
// Images as the OpenCLIP encoder wants them (docs/method.md#seva-image-encoder).

#include <vector>

#include "oraclegs/networks/common/tensor.h"

namespace oraclegs::seva {

/// images [B, 3, H, W] float32 RGB in [-1, 1], sides >= 2 -> [B, 3, side, side]: stretched, not cropped, then
/// normalized with CLIP's constants. Where an axis shrinks a Gaussian blur comes first (BlurForResize); then bicubic
/// interpolation (parameter -0.75) with aligned corners, not clamped. Throws ShapeError.
Tensor PrepareOpenClipInput(const Tensor& images, int64_t side = 224);

/// Of one axis: sigma = max((factor - 1) / 2, 0.001) pixels, factor = length / side; the weights of an odd number of
/// neighbors about 4 sigma wide, at least 3, with sum 1.
std::vector<double> ResizeBlurWeights(int64_t length, int64_t side);

/// The blur of both axes, horizontal first, the image mirrored at its border without repeating the last pixel;
/// x [B, C, H, W] itself when no axis shrinks.
Tensor BlurForResize(const Tensor& x, int64_t side);

}  // namespace oraclegs::seva
