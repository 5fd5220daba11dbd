#pragma once

#include "oraclegs/image/image.h"

namespace oraclegs {

/// Fine detail of a gray image: the variance of its Laplacian (gray levels squared). The blurred one of two images of
/// one scene and size has less. 0 for images below 3 x 3.
double Sharpness(const Image8& gray);

}  // namespace oraclegs
