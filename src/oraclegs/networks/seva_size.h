#pragma once
// Sizes at which Stable Virtual Camera works (docs/method.md#seva-image-size), without its network.

#include <cstdint>

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

/// Size of what is generated for a target, before it is brought to the target's: all of the working image that shows
/// the target's frame, its longer side filled. Throws ShapeError for sizes that are not positive.
Size GeneratedSize(const Size& target, int64_t short_side);

}  // namespace oraclegs::seva
