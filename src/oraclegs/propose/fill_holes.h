#pragma once
// Holes of a warp: unknown depths and colors.

#include <cstdint>
#include <vector>

#include "oraclegs/image/image.h"

namespace oraclegs {

/// Gives the pixels with to_fill 1 an inverse depth, ring by ring from those that have one (> 0): the far quartile of
/// the known ones in the 5x5 pixels around, since a hole beside a foreground shows what is behind it. Returns each
/// pixel's ring: 0 = was not filled; width + height where nothing could be reached.
std::vector<float> FillDepth(int width, int height, const std::vector<uint8_t>& to_fill, std::vector<float>* inv_depth);

/// Gives the pixels of weight 0 smooth colors from the others around them, near ones first: colors are averaged by
/// weight down a pyramid and interpolated back up into the holes [Gortler 1996]. A pixel of weight 1 or more keeps its
/// color, one between is mixed. weight is height * width, >= 0; where all are zero the image is unchanged.
void PushPull(const std::vector<float>& weight, ImageF* image);

}  // namespace oraclegs
