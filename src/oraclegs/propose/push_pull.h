#pragma once

#include <vector>

#include "oraclegs/image/image.h"

namespace oraclegs {

/// Gives the pixels of weight 0 smooth colours from the others around them, near ones first: colours are averaged by
/// weight down a pyramid and pulled back up into what is missing [Gortler 1996]. A
/// pixel of weight 1 or more keeps its colour, one between is mixed. weight is height * width, >= 0; where all are zero
/// the image stays as it is.
void PushPull(const std::vector<float>& weight, ImageF* image);

}  // namespace oraclegs
