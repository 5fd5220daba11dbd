#pragma once

#include <array>
#include <string>

#include "oraclegs/camera/intrinsics.h"

namespace oraclegs {

/// A camera as most programs write it: radial coefficients in even powers, then OpenCV's tangential ones
/// (docs/method.md#camera-models). Lengths are pixels.
struct BrownLens {
  int width = 0, height = 0;
  double fx = 0, fy = 0, cx = 0, cy = 0;
  std::array<double, 4> k{};
  double p1 = 0, p2 = 0;
  bool fisheye = false;  ///< the coefficients are of the angle to the axis
};

/// The smallest of COLMAP's camera models that has the lens's coefficients. Throws InputError "PLACE: ..." for k4 of a
/// lens that is no fisheye, which none has, and as Intrinsics::Check does.
Intrinsics IntrinsicsOf(const BrownLens& lens, const std::string& place);

}  // namespace oraclegs
