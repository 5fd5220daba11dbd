#pragma once

#include "oraclegs/core/buffer.h"

namespace oraclegs {

// Scores of a render against the true image (docs/method.md#metrics). Sums are taken in double over blocks of fixed
// size: the same bits for any number of threads.

/// The image clamped to [0,1] and rounded to 8 bit, as in an image file.
Buffer<float> Quantized(const Buffer<float>& image);

/// The image [H,W,3] with `other` where the mask [H,W] is 0; unchanged without a mask.
Buffer<float> WithMaskedFrom(const Buffer<float>& image, const Buffer<float>& other, const Buffer<float>& mask);

/// 20 log10(1 / sqrt(MSE)) over the pixels with mask 1 and all channels; images [H,W,3], mask [H,W] of 0 and 1 or
/// undefined. Identical images give +inf.
double Psnr(const Buffer<float>& a, const Buffer<float>& b, const Buffer<float>& mask = {});

/// Mean SSIM over the pixels with mask 1 (11x11 Gaussian window, zero padding). Where the mask is 0 windows see the
/// second image on both sides.
double Ssim(const Buffer<float>& a, const Buffer<float>& b, const Buffer<float>& mask = {});

/// The render, [0, 1], through the best affine 3x4 color map to `target` (least squares over the pixels with mask 1).
Buffer<float> ColorCorrected(const Buffer<float>& render, const Buffer<float>& target, const Buffer<float>& mask = {});

/// PSNR of the ColorCorrected render.
double ColorCorrectedPsnr(const Buffer<float>& render, const Buffer<float>& target, const Buffer<float>& mask = {});

}  // namespace oraclegs
