#pragma once
// Meshes as Wavefront .obj.

#include "oraclegs/mesh/triangle_mesh.h"

namespace oraclegs {

/// Writes a mesh with normals and colors or texture. Beside a textured NAME.obj lie NAME.mtl and NAME_texture.png; the
/// colors of any other stand behind its positions. Returns the files, the .obj last. `comments` are its first lines.
/// Throws RunError.
std::vector<std::filesystem::path> WriteObj(const std::filesystem::path& path, const TriangleMesh& mesh,
                                            const std::vector<std::string>& comments);

}  // namespace oraclegs
