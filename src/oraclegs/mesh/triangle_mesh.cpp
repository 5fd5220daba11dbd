#include "oraclegs/mesh/triangle_mesh.h"

#include <Eigen/Geometry>
#include <numeric>

namespace oraclegs {
namespace {

/// Normal of the triangle; its length is twice the area.
Eigen::Vector3f CrossOf(const TriangleMesh& mesh, const std::array<uint32_t, 3>& triangle) {
  const Eigen::Vector3f &a = mesh.positions[triangle[0]], &b = mesh.positions[triangle[1]],
                        &c = mesh.positions[triangle[2]];
  return (b - a).cross(c - a);
}

/// Connected components of the vertices.
class ConnectedVertices {
 public:
  explicit ConnectedVertices(size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }

  uint32_t Of(uint32_t vertex) {
    while (parent_[vertex] != vertex) vertex = parent_[vertex] = parent_[parent_[vertex]];
    return vertex;
  }
  void Join(uint32_t a, uint32_t b) { parent_[Of(a)] = Of(b); }

 private:
  std::vector<uint32_t> parent_;
};

}  // namespace

void SetNormals(TriangleMesh* mesh) {
  mesh->normals.assign(mesh->positions.size(), Eigen::Vector3f::Zero());
  for (const auto& triangle : mesh->triangles) {
    const Eigen::Vector3f cross = CrossOf(*mesh, triangle);
    for (const uint32_t vertex : triangle) mesh->normals[vertex] += cross;
  }
  for (Eigen::Vector3f& normal : mesh->normals) {
    const float length = normal.norm();
    normal = length > 0 ? Eigen::Vector3f(normal / length) : Eigen::Vector3f(0, 0, 1);
  }
}

TriangleMesh PartOf(const TriangleMesh& mesh, const std::vector<std::array<uint32_t, 3>>& triangles) {
  constexpr uint32_t kUnused = UINT32_MAX;
  std::vector<uint32_t> renamed(mesh.positions.size(), kUnused);
  TriangleMesh part;
  part.triangles.reserve(triangles.size());
  for (std::array<uint32_t, 3> triangle : triangles) {
    for (uint32_t& vertex : triangle) {
      uint32_t& name = renamed[vertex];
      if (name == kUnused) {
        name = static_cast<uint32_t>(part.positions.size());
        part.positions.push_back(mesh.positions[vertex]);
        if (!mesh.normals.empty()) part.normals.push_back(mesh.normals[vertex]);
        if (!mesh.colors.empty()) part.colors.push_back(mesh.colors[vertex]);
      }
      vertex = name;
    }
    part.triangles.push_back(triangle);
  }
  return part;
}

TriangleMesh WithoutSmallParts(const TriangleMesh& mesh, double min_share) {
  ConnectedVertices connected(mesh.positions.size());
  for (const auto& t : mesh.triangles) connected.Join(t[0], t[1]), connected.Join(t[1], t[2]);
  std::vector<double> area(mesh.positions.size());
  double all = 0;
  for (const auto& triangle : mesh.triangles) {
    const double twice = CrossOf(mesh, triangle).norm();
    area[connected.Of(triangle[0])] += twice;
    all += twice;
  }
  std::vector<std::array<uint32_t, 3>> kept;
  for (const auto& triangle : mesh.triangles) {
    if (area[connected.Of(triangle[0])] >= min_share * all) kept.push_back(triangle);
  }
  return PartOf(mesh, kept);
}

}  // namespace oraclegs
