#pragma once
// Images are brought to the size that SEVA works at, and what it generates back to theirs
// (docs/method.md#seva-image-size).

#include <Eigen/Core>
#include <cstdint>

#include "oraclegs/networks/common/tensor.h"

namespace oraclegs::seva {

struct Size {
  int64_t width = 576, height = 576;
};

/// Working size: the shorter side becomes `short_side`, the other keeps the aspect ratio; both are rounded to multiples
/// of `stride`. Throws ShapeError unless all are positive.
Size WorkingSize(const Size& original, int64_t short_side, int64_t stride = 64);

enum class FitMode {
  kCrop,  ///< fills the working image and cuts off what extends beyond two sides; for input images
  kPad    ///< keeps the whole image, with two empty strips beside it; for targets, so that nothing is missing when they
          ///< come back
};

/// Position of the resized image in the working image, in pixels of the working image.
struct ImageFit {
  Size original, resized, working;
  int64_t left = 0, top = 0;  ///< corner of the resized image; negative where it extends beyond
};
/// Throws ShapeError for sizes that are not positive.
ImageFit FitImage(const Size& original, const Size& working, FitMode mode);

/// Intrinsics in pixels of the image -> fractions of the working image's width (row 0) and height (row 1).
Eigen::Matrix3d FittedIntrinsics(const Eigen::Matrix3d& pixels, const ImageFit& fit);

/// image [B, C, h, w] -> [B, C, H, W]: averages pixel areas (repeats pixels where it grows); zeros outside the image.
Tensor ToWorkingSize(const Tensor& image, const ImageFit& fit);

/// Inverse of ToWorkingSize: [B, C, H, W] -> [B, C, h, w], bicubic, antialiased where it shrinks; what was cut off
/// repeats the border.
Tensor FromWorkingSize(const Tensor& image, const ImageFit& fit);

}  // namespace oraclegs::seva
