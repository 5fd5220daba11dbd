#include "oraclegs/mesh/simplify.h"

#include <meshoptimizer.h>

#include "oraclegs/core/error.h"

namespace oraclegs {
namespace {

constexpr float kAnyError = 1;  // of the extent: collapses are made in the order of their errors, and end at the number

using Triangles = std::vector<std::array<uint32_t, 3>>;

const uint32_t* IndicesOf(const Triangles& triangles) { return reinterpret_cast<const uint32_t*>(triangles.data()); }

Triangles Collapsed(const TriangleMesh& mesh, size_t most) {
  Triangles kept(mesh.triangles.size());
  const size_t indices = meshopt_simplify(reinterpret_cast<uint32_t*>(kept.data()), IndicesOf(mesh.triangles),
                                          3 * mesh.triangles.size(), mesh.positions.front().data(),
                                          mesh.positions.size(), sizeof(Eigen::Vector3f), 3 * most, kAnyError);
  kept.resize(indices / 3);
  return kept;
}

/// Vertices in one cell of a grid become one.
Triangles Clustered(const TriangleMesh& mesh, const Triangles& triangles, size_t most) {
  Triangles kept(triangles.size());
  const size_t indices = meshopt_simplifySloppy(reinterpret_cast<uint32_t*>(kept.data()), IndicesOf(triangles),
                                                3 * triangles.size(), mesh.positions.front().data(),
                                                mesh.positions.size(), sizeof(Eigen::Vector3f), 3 * most, kAnyError);
  kept.resize(indices / 3);
  return kept;
}

}  // namespace

TriangleMesh Simplified(const TriangleMesh& mesh, int most) {
  if (most != 0 && most < kMinTriangles) throw ShapeError("Simplified: to {} triangles", most);
  const auto wanted = static_cast<size_t>(most);
  if (most == 0 || mesh.triangles.size() <= wanted) return mesh;
  Triangles triangles = Collapsed(mesh, wanted);
  if (triangles.size() > wanted) triangles = Clustered(mesh, triangles, wanted);
  return PartOf(mesh, triangles);
}

}  // namespace oraclegs
