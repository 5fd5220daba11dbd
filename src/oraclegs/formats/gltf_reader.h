#pragma once

#include <string>
#include <string_view>

#include "oraclegs/formats/values.h"

namespace oraclegs {

/// A .glb file (gltf_writer.h): all primitives of the extension in all nodes, where their nodes put them, with
/// attributes of any type that it allows; also those that keep their Gaussians as SPZ. Throws InputError naming `file`:
/// no binary glTF or none with Gaussians, bytes outside the file, accessors that leave their bytes, nodes that are no
/// tree or scale unevenly, a mesh of Gaussians at two nodes, primitives that share bytes so often that the file
/// promises far more Gaussians than it can hold, too many damaged rows. Colors of the space lin_rec709_display
/// are converted, with a warning.
GaussianPly DecodeGltf(std::string_view bytes, const std::string& file);

}  // namespace oraclegs
