#pragma once
// Images as VGGT wants them (docs/method.md#vggt-input).

#include <vector>

#include "oraclegs/image/image.h"
#include "oraclegs/networks/common/tensor.h"

namespace oraclegs::vggt {

/// How an image is brought to the network's size.
enum class Fit {
  kCrop,   ///< official default: 518 wide, what is higher than 518 is cut off above and below
  kPad,    ///< official: the longer side 518, white around it
  kWhole,  ///< ours: the longer side 518, nothing cut, nothing added; white patches would draw attention
};

/// Where an image lies in the network's input.
struct InputPlace {
  int64_t width = 0, height = 0;  ///< of the resized image; the two axes are scaled on their own
  int64_t left = 0, top = 0;      ///< of its first pixel; top is negative where it was cropped
};

struct Input {
  Tensor images;  ///< [S, 3, H, W] float32 RGB in [0, 1]
  std::vector<InputPlace> places;
};

/// images: 3 or 4 channels; transparency is composited over white. Views that differ in size are padded with white to
/// the largest. Throws ShapeError when there are none or one has no pixel or another number of channels.
Input PrepareInput(const std::vector<Image8>& images, Fit fit, int64_t side = 518, int64_t patch = 14);

/// Pillow's bicubic filter (antialiased when shrinking, 8 bits between the passes), bit for bit. Throws ShapeError when
/// a size is not positive.
Image8 ResizeLikePillow(const Image8& image, int width, int height);

}  // namespace oraclegs::vggt
