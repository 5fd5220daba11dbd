#pragma once

#include "oraclegs/core/buffer.h"

namespace oraclegs {

/// Clamp to [0,1] and round to 8 bit: what a picture file would hold (spec/gaussian_core.md 11).
Buffer<float> Quantized(const Buffer<float>& image);

/// 20 log10(1 / sqrt(MSE)) over the pixels with mask 1 and all channels; images [H,W,3], mask [H,W] or undefined.
/// Identical images give +inf.
double Psnr(const Buffer<float>& a, const Buffer<float>& b, const Buffer<float>& mask = {});

/// Mean SSIM over the pixels with mask 1 (11x11 Gaussian window, zero padding); where the mask is 0 the first picture
/// has no say, windows see the second there.
double Ssim(const Buffer<float>& a, const Buffer<float>& b, const Buffer<float>& mask = {});

/// PSNR after the affine 3x4 colour map (least squares over the masked pixels) that best takes `render` to `target`.
double ColorCorrectedPsnr(const Buffer<float>& render, const Buffer<float>& target, const Buffer<float>& mask = {});

}  // namespace oraclegs
