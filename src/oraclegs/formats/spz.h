#pragma once
// SPZ of Niantic: quantised Gaussians, attribute by attribute, compressed by gzip; versions 2 and 3. Its axes are x
// right, y up, z back, while the program's are x right, y down, z forward: what is written is turned by half a turn
// about the x axis, and turned back when it is read.

#include <string>
#include <string_view>

#include "oraclegs/formats/values.h"

namespace oraclegs {

enum class SpzVersion {
  k2 = 2,  ///< rotations of 3 bytes; what glTF allows
  k3 = 3,  ///< of 4 bytes, many times as exact
};

/// The bytes of a .spz file; the Gaussians keep their order. Errors by the quantisation: opacity 1/510, colour 0.0037,
/// log scales 1/32, quaternion 0.0007 a component (version 2: 0.004), harmonics above degree 0 1/64 within [-1, 1]
/// (1/32 and 1/16 for Gaussians of an opacity below 0.25 and 0.08); positions 1/32 of the median Gaussian's middle
/// standard deviation, unless the scene is so large that 24 bits cannot hold that.
std::string EncodeSpz(const Gaussians& gaussians, int sh_degree, SpzVersion version = SpzVersion::k3);

/// Throws InputError naming `file`: not gzip, no SPZ or one of another version, lengths that do not fit, more than 4
/// MiB that were packed to less than 1/200.
GaussianPly DecodeSpz(std::string_view bytes, const std::string& file);

}  // namespace oraclegs
