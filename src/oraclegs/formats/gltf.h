#pragma once
// glTF 2.0 in one binary file (.glb) with the ratified extension KHR_gaussian_splatting: a primitive of points, whose
// attributes are the Gaussians. glTF's axes are x left, y up, z forward, the program's x right, y down, z forward: what
// is written is turned by half a turn about the z axis.

#include <string>
#include <string_view>
#include <vector>

#include "oraclegs/formats/values.h"
#include "oraclegs/gaussians/gaussians.h"

namespace oraclegs {

/// The bytes of a .glb file: all attributes as float32, without loss but rounding, in the order of the Gaussians.
/// Viewers that do not know the extension show colored points. Support, if given, is the attribute _SUPPORT. Throws
/// RunError where the file would have more than 4 GB.
std::string EncodeGltf(const Gaussians& gaussians, int sh_degree, const std::vector<float>& support = {});

/// The bytes of a .glb that holds the Gaussians, in their order, as SPZ of version 2, whose errors it has: a draft of
/// an extension (KHR_gaussian_splatting_compression_spz_2), which a reader must know.
std::string EncodeGltfSpz(const Gaussians& gaussians, int sh_degree);

/// A .glb file (gltf.h): all primitives of the extension in all nodes, where their nodes put them, with
/// attributes of any type that it allows; also those that keep their Gaussians as SPZ. Throws InputError naming `file`:
/// no binary glTF or none with Gaussians, bytes outside the file, accessors that leave their bytes, nodes that are no
/// tree or scale unevenly, a mesh of Gaussians at two nodes, primitives that share bytes so often that the file
/// promises far more Gaussians than it can hold, too many damaged rows. Colors of the space lin_rec709_display
/// are converted, with a warning.
GaussianPly DecodeGltf(std::string_view bytes, const std::string& file);

/// The sRGB value of linear light; below 0 the line through 0 goes on.
float SrgbOfLinear(float linear);

/// Replaces linear colors by sRGB ones, in place and on the host: for each channel of a Gaussian the transfer curve
/// between two points, a standard deviation below and above the mean over all directions, so that both are kept. Exact
/// for a color that is the same from everywhere.
void ColorsFromLinear(int sh_degree, Gaussians* gaussians);

}  // namespace oraclegs
