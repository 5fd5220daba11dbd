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

/// The shorter side becomes `short_side`, the other keeps the shape; both rounded to multiples of `stride`. Throws
/// ShapeError unless all are positive.
Size WorkingSize(const Size& original, int64_t short_side, int64_t stride = 64);

enum class FitMode {
  kCrop,  ///< the working image is filled, what hangs over at two sides is cut off: input images
  kPad    ///< all of the image's frame is inside, two strips of the working image are beyond it: targets, so
          ///< that nothing of them is missing when they come back
};

/// Where the resized image lies in the working image, in pixels of that.
struct ImageFit {
  Size original, resized, working;
  int64_t left = 0, top = 0;  ///< of the resized image; negative where it hangs over
};
/// Throws ShapeError for sizes that are not positive.
ImageFit FitImage(const Size& original, const Size& working, FitMode mode);

/// Intrinsics in pixels of the image -> in shares of the working image's width (row 0) and height (row 1).
Eigen::Matrix3d FittedIntrinsics(const Eigen::Matrix3d& pixels, const ImageFit& fit);

/// image [B, C, h, w] -> [B, C, H, W]: pixel areas averaged (repeated where it grows); zeros beyond the image.
Tensor ToWorkingSize(const Tensor& image, const ImageFit& fit);

/// The reverse: [B, C, H, W] -> [B, C, h, w], bicubic, antialiased where it shrinks; what was cut off repeats the
/// border.
Tensor FromWorkingSize(const Tensor& image, const ImageFit& fit);

}  // namespace oraclegs::seva
