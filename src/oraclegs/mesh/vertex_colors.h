#pragma once

#include <array>
#include <vector>

#include "oraclegs/mesh/surface_view.h"
#include "oraclegs/mesh/triangle_mesh.h"

namespace oraclegs {

/// Means of the colors that views show at the vertices of a mesh.
class VertexColors {
 public:
  /// `mesh` has normals and must live as long; `tolerance`: a vertex so far behind the surface that a view shows is
  /// hidden from it, scene units.
  VertexColors(const TriangleMesh& mesh, double tolerance);

  /// Weighted as depth is (surface_view.h).
  void Add(const SurfaceView& view);

  /// sRGB of each vertex; of those that no view shows, gray.
  std::vector<std::array<uint8_t, 3>> Colors() const;

 private:
  const TriangleMesh& mesh_;
  float tolerance_;
  std::vector<Eigen::Vector3f> sums_;
  std::vector<float> weights_;
};

}  // namespace oraclegs
