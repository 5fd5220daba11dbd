#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "oraclegs/image/image.h"

namespace oraclegs {

/// A surface of triangles in the frame of the scene. Counter-clockwise seen from outside.
struct TriangleMesh {
  std::vector<Eigen::Vector3f> positions;          ///< scene units
  std::vector<Eigen::Vector3f> normals;            ///< unit, outward; as many as positions, or none
  std::vector<std::array<uint8_t, 3>> colors;      ///< sRGB; as many as positions, or none
  std::vector<std::array<uint32_t, 3>> triangles;  ///< indices of positions
  std::vector<Eigen::Vector2f> texcoords;          ///< in [0, 1] from the texture's upper left corner; or none
  Image8 texture;                                  ///< sRGB, in place of colors; or empty
};

/// Sets the normals of the vertices: means of their triangles', weighted by area.
void SetNormals(TriangleMesh* mesh);

/// Part of a mesh: these triangles of its vertices, and the vertices that they use.
TriangleMesh PartOf(const TriangleMesh& mesh, const std::vector<std::array<uint32_t, 3>>& triangles);

/// The mesh without connected parts of less than `min_share` of the whole area, and without vertices that no triangle
/// uses.
TriangleMesh WithoutSmallParts(const TriangleMesh& mesh, double min_share);

/// Writes a mesh with normals and colors or texture, atomically, in the format of the extension: .ply (binary,
/// little-endian, no texture), .glb (glTF 2.0, unlit; the unit vector `up` becomes its y axis) or .obj (with a .mtl and
/// a .png for a texture). `comments` are lines at the beginning of a .ply or .obj, or asset.extras in a .glb. Returns
/// the files written. Throws UsageError for another extension or a mesh that needs more than 4 GiB as .glb, RunError
/// when it cannot be written.
std::vector<std::filesystem::path> WriteMesh(const std::filesystem::path& path, const TriangleMesh& mesh,
                                             const Eigen::Vector3d& up, const std::vector<std::string>& comments = {});

/// Throws UsageError for an extension that WriteMesh does not write.
void RequireMeshExtension(const std::filesystem::path& path);

/// False for a .ply, which WriteMesh gives vertex colors alone.
bool HoldsTexture(const std::filesystem::path& path);

}  // namespace oraclegs
