#pragma once
// Input of VGGT (docs/method.md#vggt-input).

#include <vector>

#include "oraclegs/image/image.h"
#include "oraclegs/networks/common/tensor.h"

namespace oraclegs::vggt {

/// Way in which an image is brought to the network's size.
enum class Fit {
  kCrop,   ///< official default: 518 wide, rows beyond 518 are cut off above and below
  kPad,    ///< official: the longer side 518, white around it
  kWhole,  ///< ours: the longer side 518, nothing cut, nothing added, since white patches would draw attention
};

/// Position of an image in the network's input.
struct InputPlace {
  int64_t width = 0, height = 0;  ///< size of the resized image; the two axes are scaled on their own
  int64_t left = 0, top = 0;      ///< first pixel of the image; top is negative where it was cropped
};

struct Input {
  Tensor images;  ///< [S, 3, H, W] float32 RGB in [0, 1]
  std::vector<InputPlace> places;
};

/// images have 3 or 4 channels; transparency is composited over white. Views that differ in size are padded with white
/// to the largest. Throws ShapeError for an empty list, an image without pixels, or another number of channels.
Input PrepareInput(const std::vector<Image8>& images, Fit fit, int64_t side = 518, int64_t patch = 14);

}  // namespace oraclegs::vggt
