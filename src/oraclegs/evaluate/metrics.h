#pragma once

#include "oraclegs/core/buffer.h"

namespace oraclegs {

// Scores of a render against the true image (docs/method.md#metrics). Sums are taken in double over blocks of fixed
// size: the same bits for any number of threads.

/// Clamp to [0,1] and round to 8 bit: what an image file would hold.
Buffer<float> Quantized(const Buffer<float>& image);

/// The image [H,W,3], but `other` where the mask [H,W] is 0; the image itself without a mask.
Buffer<float> WithMaskedFrom(const Buffer<float>& image, const Buffer<float>& other, const Buffer<float>& mask);

/// 20 log10(1 / sqrt(MSE)) over the pixels with mask 1 and all channels; images [H,W,3], mask [H,W] of 0 and 1 or
/// undefined. Identical images give +inf.
double Psnr(const Buffer<float>& a, const Buffer<float>& b, const Buffer<float>& mask = {});

/// Mean SSIM over the pixels with mask 1 (11x11 Gaussian window, zero padding); where the mask is 0 the first image
/// is ignored, windows see the second there.
double Ssim(const Buffer<float>& a, const Buffer<float>& b, const Buffer<float>& mask = {});

/// PSNR after the affine 3x4 color map (least squares over the masked pixels) that best takes `render` to `target`.
double ColorCorrectedPsnr(const Buffer<float>& render, const Buffer<float>& target, const Buffer<float>& mask = {});

}  // namespace oraclegs
