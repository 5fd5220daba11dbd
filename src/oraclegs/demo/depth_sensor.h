#pragma once
// Depth of a demo scene as a sensor would measure it.

#include <cstdint>
#include <vector>

#include "oraclegs/image/image.h"

namespace oraclegs {

/// A sensor's picture: half the size of the photo.
struct SensedDepth {
  int width = 0, height = 0;
  std::vector<uint16_t> depth;  ///< 1/1000 scene unit, 0 = none
  Image8 confidence;            ///< 0 low, 127 medium, 255 high
};

/// From true depth (RayTracedView::depth) of a photo of this size: noise of 5/1000 unit; nothing in holes; where the
/// surface breaks off, the mean of both sides, of medium confidence; in patches, depth that is a tenth too far, of low
/// confidence. `view` selects the random numbers. The same on every machine.
SensedDepth SenseDepth(const std::vector<uint16_t>& truth, int width, int height, int view);

}  // namespace oraclegs
