#pragma once

#include <array>
#include <vector>

#include "oraclegs/mesh/surface_view.h"
#include "oraclegs/mesh/triangle_mesh.h"

namespace oraclegs {

/// Means of the colors that views show at the vertices of a mesh.
class VertexColors {
 public:
  /// Takes a mesh with normals, which must outlive this. tolerance: distance behind a view's surface from which a
  /// vertex is hidden from it, scene units.
  VertexColors(const TriangleMesh& mesh, double tolerance);

  /// Adds a view, weighted as its depth (surface_view.h).
  void Add(const SurfaceView& view);

  /// sRGB of each vertex; gray where no view shows it.
  std::vector<std::array<uint8_t, 3>> Colors() const;
  /// Number of views that show a vertex.
  int Views(size_t vertex) const { return views_[vertex]; }

 private:
  const TriangleMesh& mesh_;
  float tolerance_;
  std::vector<Eigen::Vector3f> sums_;
  std::vector<float> weights_;
  std::vector<int> views_;
};

}  // namespace oraclegs
