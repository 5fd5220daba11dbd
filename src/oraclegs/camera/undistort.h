#pragma once

#include <cstdint>
#include <vector>

#include "oraclegs/camera/camera.h"
#include "oraclegs/camera/intrinsics.h"
#include "oraclegs/image/image.h"

namespace oraclegs {

/// The pinhole camera (identity pose) of the same size that sees as much as possible of what `intrinsics` see without a
/// blank pixel at the border: the principal point is kept, the focal length is scaled by 0.2 to 5. A pinhole model
/// keeps its focal length, and so does one whose axis lies outside the image (no scale fills its border).
Camera UndistortedCamera(const Intrinsics& intrinsics);

struct UndistortedImage {
  ImageF image;
  std::vector<uint8_t> valid;  ///< height * width, 1 where the source was seen; empty when all are
};

/// Resamples `source` (any channel count, taken with `intrinsics`) as `target` sees it, bilinearly.
UndistortedImage Undistort(const ImageF& source, const Intrinsics& intrinsics, const Camera& target);

}  // namespace oraclegs
