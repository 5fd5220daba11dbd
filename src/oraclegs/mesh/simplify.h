#pragma once
// Fewer triangles for the same surface.

#include "oraclegs/mesh/triangle_mesh.h"

namespace oraclegs {

inline constexpr int kMinTriangles = 100;  ///< fewer show no shape

/// The surface with at most `most` triangles (0 = all of them, else kMinTriangles or more), by the collapses of edges
/// that move it least; where its topology allows too few of them, also parts that are near each other become one. The
/// vertices are some of the mesh's own.
TriangleMesh Simplified(const TriangleMesh& mesh, int most);

}  // namespace oraclegs
