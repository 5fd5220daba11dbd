#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace oraclegs {

/// A surface of triangles in the frame of the scene. Counter-clockwise seen from outside.
struct TriangleMesh {
  std::vector<Eigen::Vector3f> positions;          ///< scene units
  std::vector<Eigen::Vector3f> normals;            ///< unit, outward; as many as positions, or none
  std::vector<std::array<uint8_t, 3>> colors;      ///< sRGB; as many as positions, or none
  std::vector<std::array<uint32_t, 3>> triangles;  ///< indices of positions
};

/// Sets the normals of the vertices: means of their triangles', weighted by area.
void SetNormals(TriangleMesh* mesh);

/// The mesh without connected parts of less than `min_share` of the whole area, and without vertices that no triangle
/// uses.
TriangleMesh WithoutSmallParts(const TriangleMesh& mesh, double min_share);

/// Writes a mesh with normals and colors, atomically, in the format of the extension: .ply (binary, little-endian) or
/// .glb (glTF 2.0, unlit; the unit vector `up` becomes its y axis). `comments` are lines of a .ply's header, or of
/// asset.extras in a .glb. Throws UsageError for another extension or a mesh that needs more than 4 GiB as .glb,
/// RunError when it cannot be written.
void WriteMesh(const std::filesystem::path& path, const TriangleMesh& mesh, const Eigen::Vector3d& up,
               const std::vector<std::string>& comments = {});

/// Throws UsageError for an extension that WriteMesh does not write.
void RequireMeshExtension(const std::filesystem::path& path);

}  // namespace oraclegs
