#pragma once

#include <cstdint>
#include <vector>

#include "oraclegs/image/image.h"

namespace oraclegs {

/// An image in 8 bits, laid out so that one 32-bit load fetches the four pixels of a bilinear sample: word (x, y) of a
/// channel holds, lowest byte first, the pixels (x, y), (x+1, y), (x, y+1), (x+1, y+1); beyond the border the last
/// pixel repeats.
struct GatherImage {
  int width = 0, height = 0;
  std::vector<std::vector<uint32_t>> channels;  ///< each height * width words

  uint8_t Value(int channel, int x, int y) const {
    return static_cast<uint8_t>(channels[static_cast<size_t>(channel)][static_cast<size_t>(y) * width + x]);
  }
};

/// Packs every channel of `image`, whose values in [0, 1] are rounded to 8 bits.
GatherImage Pack(const ImageF& image);

/// Rec. 601 luma of an RGB image, one channel.
ImageF Luma(const ImageF& rgb);

}  // namespace oraclegs
