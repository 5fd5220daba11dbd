#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
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

}  // namespace oraclegs
