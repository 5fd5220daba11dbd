#pragma once
// Pictures that are tampered with in parts, from which an oracle learns disagreement
// (docs/method.md#tamper-trained-oracle).

#include <vector>

#include "oraclegs/core/rng.h"
#include "oraclegs/image/image.h"

namespace oraclegs {

/// Kinds of replacement of a part of an image.
enum class TamperKind {
  kOtherImage,  ///< content of another image
  kElsewhere,   ///< content of the image itself, from far away
  kDisplaced,   ///< content of the image itself, from nearby, as with wrong geometry
  kTone,        ///< its colors through a random gain and offset of each channel
  kBlur,        ///< its mean over windows
};
inline constexpr int kTamperKinds = 5;

struct Tampered {
  ImageF rgb;
  std::vector<float> share;  ///< height * width, [0, 1]: how far each pixel is replaced
};

/// Replaces parts of `image`, ellipses and boxes of several sizes with soft edges, each by a random kind, until `share`
/// of its pixels are replaced (but at most 64 parts). `other` may have another size; an empty one is not used. All
/// images have 3 channels. Throws ShapeError for an empty image.
Tampered Tamper(const ImageF& image, const ImageF& other, double share, Rng* rng);

/// Image rotated by 180 degrees: an entirely wrong picture.
ImageF UpsideDown(const ImageF& image);
/// Middle of the image, enlarged by `factor` > 1 to the image's size.
ImageF Zoomed(const ImageF& image, double factor);

}  // namespace oraclegs
