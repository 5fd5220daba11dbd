#pragma once

#include "oraclegs/validate/oracle.h"

namespace oraclegs {

/// Each pixel becomes the mean of the 5x5 around it, weighed by (1 4 6 4 1) along both axes; at the border by what of
/// that lies within. A prediction from one pixel's features is noisy; its neighbors show the same surface, and a
/// proposal that is misplaced is wrong on both sides of an edge. Throws ShapeError when the map has not width * height
/// pixels.
void Smooth(int width, int height, ConfidenceMap* map);

}  // namespace oraclegs
