#pragma once

#include <cstdint>

#include "oraclegs/core/device_macros.h"

namespace oraclegs {

/// Region of one image in which an object may be, for host and device; see Silhouettes.
struct SilhouetteMask {
  const uint8_t* grown = nullptr;  ///< height * width, 0 = more than two pixels from the object
  int width = 0, height = 0;

  /// Whether the object may be at (x, y); true outside the image, where nothing is known.
  ORACLEGS_HD inline bool MayContain(float x, float y) const {
    if (!(x >= 0 && y >= 0 && x < static_cast<float>(width) && y < static_cast<float>(height))) return true;
    return grown[static_cast<int64_t>(y) * width + static_cast<int64_t>(x)] != 0;
  }
};

}  // namespace oraclegs
