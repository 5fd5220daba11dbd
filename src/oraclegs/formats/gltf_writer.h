#pragma once
// glTF 2.0 in one binary file (.glb) with the ratified extension KHR_gaussian_splatting: a primitive of points, whose
// attributes are the Gaussians. glTF's axes are x left, y up, z forward, the program's x right, y down, z forward: what
// is written is turned by half a turn about the z axis.

#include <string>
#include <vector>

#include "oraclegs/formats/values.h"

namespace oraclegs {

/// The bytes of a .glb file: all attributes as float32, without loss but rounding, in the order of the Gaussians.
/// Viewers that do not know the extension show colored points. Support, if given, is the attribute _SUPPORT. Throws
/// RunError where the file would have more than 4 GB.
std::string EncodeGltf(const Gaussians& gaussians, int sh_degree, const std::vector<float>& support = {});

/// The bytes of a .glb that holds the Gaussians, in their order, as SPZ of version 2, whose errors it has: a draft of
/// an extension (KHR_gaussian_splatting_compression_spz_2), which a reader must know.
std::string EncodeGltfSpz(const Gaussians& gaussians, int sh_degree);

}  // namespace oraclegs
