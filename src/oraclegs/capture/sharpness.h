#pragma once

#include "oraclegs/image/image.h"

namespace oraclegs {

/// How much fine detail a gray image has: the variance of its Laplacian (gray levels squared). Of two images of one
/// scene and size, the blurred one has less. 0 for images below 3 x 3.
double Sharpness(const Image8& gray);

}  // namespace oraclegs
