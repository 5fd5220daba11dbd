#pragma once
// .splat: 32 bytes a Gaussian without a header, as the first viewers of the web read it. No view-dependent colour.

#include <string>
#include <string_view>

#include "oraclegs/formats/values.h"

namespace oraclegs {

/// Position and standard deviations as float32, colour and opacity as bytes, w,x,y,z of the rotation as bytes; the
/// Gaussians keep their order. Errors: colour and opacity 1/510, quaternion 1/128 a component; colours beyond [0,1] are
/// cut. Fast: a pass over the numbers.
std::string EncodeSplat(const Gaussians& gaussians);

/// Throws InputError naming `file`: a size that is no multiple of 32, numbers that are not finite.
GaussianPly DecodeSplat(std::string_view bytes, const std::string& file);

}  // namespace oraclegs
