#pragma once
// Pictures that lie in places: what an oracle learns disagreement from (docs/method.md#tamper-trained-oracle).

#include <vector>

#include "oraclegs/core/rng.h"
#include "oraclegs/image/image.h"

namespace oraclegs {

/// What a part of an image is replaced with.
enum class TamperKind {
  kOtherImage,  ///< content of another image
  kElsewhere,   ///< content of the same image from far away
  kDisplaced,   ///< the same from nearby, as of geometry that is wrong
  kTone,        ///< its colors through a random gain and offset of each channel
  kBlur,        ///< its mean over windows
};
inline constexpr int kTamperKinds = 5;

struct Tampered {
  ImageF rgb;
  std::vector<float> share;  ///< height * width, [0, 1], how far a pixel is replaced
};

/// Replaces parts of `image`, ellipses and boxes of several sizes with soft edges, each in a random way, until `share`
/// of its pixels are replaced (but at most 64 parts). `other` may have another size; empty: nothing comes from it. All
/// images have 3 channels. Throws ShapeError for an empty image.
Tampered Tamper(const ImageF& image, const ImageF& other, double share, Rng* rng);

/// What is seen where the whole picture is wrong: rotated by 180 degrees.
ImageF UpsideDown(const ImageF& image);
/// The middle of the image, enlarged by `factor` > 1 to its size.
ImageF Zoomed(const ImageF& image, double factor);

}  // namespace oraclegs
