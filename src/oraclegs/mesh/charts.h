#pragma once
// Pieces of a surface that are nearly flat, for a texture.

#include "oraclegs/mesh/triangle_mesh.h"

namespace oraclegs {

/// A connected piece of a mesh, projected onto a plane.
struct Chart {
  std::vector<uint32_t> vertices;       ///< of the mesh
  std::vector<Eigen::Vector2f> places;  ///< of the vertices in the plane, scene units; the least of x and y are 0
  std::vector<std::array<uint32_t, 3>> corners;  ///< of its triangles, indices of vertices and places
  Eigen::Vector2f size;                          ///< greatest x and y
};

/// Charts of all triangles of a mesh with normals, which turn less than 60 degrees from their first one. Longer than
/// high. Equal meshes give equal charts.
std::vector<Chart> ChartsOf(const TriangleMesh& mesh);

}  // namespace oraclegs
