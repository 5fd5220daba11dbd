#pragma once
// Images are brought to the size that SEVA works at, and what it generates back to theirs
// (docs/method.md#seva-image-size).

#include <Eigen/Core>

#include "oraclegs/networks/common/tensor.h"
#include "oraclegs/networks/seva_size.h"

namespace oraclegs::seva {

/// Intrinsics in pixels of the image -> fractions of the working image's width (row 0) and height (row 1).
Eigen::Matrix3d FittedIntrinsics(const Eigen::Matrix3d& pixels, const ImageFit& fit);

/// image [B, C, h, w] -> [B, C, H, W]: averages pixel areas (repeats pixels where it grows); zeros outside the image.
Tensor ToWorkingSize(const Tensor& image, const ImageFit& fit);

/// Inverse of ToWorkingSize: [B, C, H, W] -> [B, C, h, w], bicubic, antialiased where it shrinks; what was cut off
/// repeats the border.
Tensor FromWorkingSize(const Tensor& image, const ImageFit& fit);

}  // namespace oraclegs::seva
