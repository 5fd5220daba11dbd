#pragma once

#include "oraclegs/validate/oracle.h"

namespace oraclegs {

/// Replaces each pixel by the weighted mean of the 5x5 around it, with weights (1 4 6 4 1) along both axes, normalized
/// at the border. A prediction from one pixel's features is noisy; its neighbors show the same surface, and a misplaced
/// proposal is wrong on both sides of an edge. Throws ShapeError when the map has not width * height pixels.
void Smooth(int width, int height, ConfidenceMap* map);

}  // namespace oraclegs
