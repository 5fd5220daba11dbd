#pragma once
// SPZ of Niantic: quantized Gaussians, attribute by attribute; versions 2 and 3 are written, 1 to 4 read. Its axes are
// x right, y up, z back, while the program's are x right, y down, z forward: what is written is turned by half a turn
// about the x axis, and turned back when it is read.

#include <string>
#include <string_view>

#include "oraclegs/formats/values.h"

namespace oraclegs {

enum class SpzVersion {
  k2 = 2,  ///< rotations of 3 bytes; what glTF allows
  k3 = 3,  ///< rotations of 4 bytes, many times as exact
};

/// The bytes of a .spz file; the Gaussians keep their order. Errors by the quantization: opacity 1/510, color 0.0037
/// within [-0.44, 1.44], log scales 1/32 within [-10, 5.9], quaternion 0.0007 a component (version 2: 0.004), harmonics
/// above degree 0 1/64 within [-1, 1] (1/32 and 1/16 for Gaussians of an opacity below 0.25 and 0.08); positions 1/32
/// of the median Gaussian's middle standard deviation, or up to 1/4 of it where 24 bits cannot hold the scene more
/// exactly. Where they do not hold that either, all but the farthest hundredth get the exactness that there is, and
/// what lies beyond the border stops there: WriteSplat refuses such files.
std::string EncodeSpz(const Gaussians& gaussians, int sh_degree, SpzVersion version = SpzVersion::k3,
                      bool antialiased = false);

/// Reads SPZ of versions 1 to 4; 1 to 3 also without gzip. Harmonics of degree 4 are read to degree 3 and extensions
/// are passed over, each with a warning. Throws InputError naming `file` (UnpackSpz).
GaussianPly DecodeSpz(std::string_view bytes, const std::string& file);

}  // namespace oraclegs
