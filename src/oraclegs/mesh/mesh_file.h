#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "oraclegs/mesh/triangle_mesh.h"

namespace oraclegs {

/// Writes a mesh with normals and colors, atomically, in the format of the extension: .ply (binary, little-endian) or
/// .glb (glTF 2.0, unlit; the unit vector `up` becomes its y axis). `comments` are lines of a .ply's header, or of
/// asset.extras in a .glb. Throws UsageError for another extension or a mesh that needs more than 4 GiB as .glb,
/// RunError when it cannot be written.
void WriteMesh(const std::filesystem::path& path, const TriangleMesh& mesh, const Eigen::Vector3d& up,
               const std::vector<std::string>& comments = {});

/// Throws UsageError for an extension that WriteMesh does not write.
void RequireMeshExtension(const std::filesystem::path& path);

/// Reads a .ply that WriteMesh wrote. Throws InputError naming the file.
TriangleMesh ReadMeshPly(const std::filesystem::path& path);

}  // namespace oraclegs
