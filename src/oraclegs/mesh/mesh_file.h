#pragma once

#include <filesystem>

#include "oraclegs/mesh/triangle_mesh.h"

namespace oraclegs {

/// Writes a mesh with normals and colours, atomically, as its extension says: .ply (binary, little-endian) or .glb
/// (glTF 2.0, unlit; `up`, unit, is what its y axis shows). Throws UsageError for another extension or a mesh that
/// needs more than 4 GiB as .glb, RunError when it cannot be written.
void WriteMesh(const std::filesystem::path& path, const TriangleMesh& mesh, const Eigen::Vector3d& up);

/// Throws UsageError as WriteMesh does for the extension.
void RequireMeshExtension(const std::filesystem::path& path);

/// Reads a .ply that WriteMesh wrote. Throws InputError naming the file.
TriangleMesh ReadMeshPly(const std::filesystem::path& path);

}  // namespace oraclegs
