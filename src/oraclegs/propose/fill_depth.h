#pragma once

#include <cstdint>
#include <vector>

namespace oraclegs {

/// Gives the pixels with to_fill 1 an inverse depth, ring by ring from those that have one (> 0): the far quartile of
/// the known ones in the 5x5 pixels around, for what opens beside a foreground is what lies behind it. Returns each
/// pixel's ring: 0 = was not filled; width + height where nothing could be reached.
std::vector<float> FillDepth(int width, int height, const std::vector<uint8_t>& to_fill, std::vector<float>* inv_depth);

}  // namespace oraclegs
