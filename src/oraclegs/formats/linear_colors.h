#pragma once
// Splats whose colors are stored as linear light, where the program has display colors: sRGB.

#include <string>

#include "oraclegs/gaussians/gaussians.h"

namespace oraclegs {

/// The sRGB value of linear light; below 0 the line through 0 goes on.
float SrgbOfLinear(float linear);

/// Replaces linear colors by sRGB ones, in place and on the host: for each channel of a Gaussian the transfer curve
/// between two points, a standard deviation below and above the mean over all directions, so that both are kept. Exact
/// for a color that is the same from everywhere.
void ColorsFromLinear(int sh_degree, Gaussians* gaussians);

/// The warning that this was done.
std::string LinearColorsConverted(const std::string& file);
/// The warning that a space of this name is taken for the one of `known`.
std::string UnknownColorSpace(const std::string& space, const std::string& known, const std::string& file);

}  // namespace oraclegs
