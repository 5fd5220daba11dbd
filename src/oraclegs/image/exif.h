#pragma once
// The application segments of a JPEG, as far as they are about its pixels: orientation, and inverted CMYK.

#include <string_view>

#include "oraclegs/image/image.h"

namespace oraclegs {

struct JpegMetadata {
  int orientation = 1;          ///< EXIF tag 0x0112: 1 to 8, 1 = upright
  bool has_adobe_mark = false;  ///< an APP14 "Adobe" segment: CMYK is stored inverted
};

/// Reads the segments before the first scan. Damage there is no error: what cannot be read keeps its default.
JpegMetadata ReadJpegMetadata(std::string_view jpeg);

/// True when the orientation swaps width and height.
bool SwapsAxes(int orientation);

/// Turns and mirrors a stored image so that it stands upright.
Image8 ApplyOrientation(Image8 image, int orientation);

}  // namespace oraclegs
