#pragma once
// .splat: 32 bytes a Gaussian without a header, as the first viewers of the web read it. No view-dependent color.

#include <string>
#include <string_view>

#include "oraclegs/formats/values.h"

namespace oraclegs {

/// Position and standard deviations as float32, color and opacity as bytes, w,x,y,z of the rotation as bytes; the
/// Gaussians keep their order. Errors: color and opacity 1/510, quaternion 1/128 a component; colors beyond [0,1] are
/// cut. Fast: a pass over the numbers.
std::string EncodeSplat(const Gaussians& gaussians);

/// Throws InputError naming `file`: a size that is no multiple of 32, numbers that are not finite.
GaussianPly DecodeSplat(std::string_view bytes, const std::string& file);

}  // namespace oraclegs
