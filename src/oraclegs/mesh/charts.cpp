#include "oraclegs/mesh/charts.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

namespace oraclegs {
namespace {

constexpr float kMinTurnCosine = 0.5f;       // between a triangle's normal and the chart's
constexpr size_t kMaxChartTriangles = 4000;  // larger ones leave more of a square empty
constexpr uint32_t kNobody = UINT32_MAX;

Eigen::Vector3f NormalTimesArea(const TriangleMesh& mesh, uint32_t triangle) {
  const auto& t = mesh.triangles[triangle];
  const Eigen::Vector3f& a = mesh.positions[t[0]];
  return (mesh.positions[t[1]] - a).cross(mesh.positions[t[2]] - a);
}

/// Triangles beyond the three edges of each; kNobody where the surface ends.
std::vector<std::array<uint32_t, 3>> TrianglesBeside(const TriangleMesh& mesh) {
  struct Edge {
    std::pair<uint32_t, uint32_t> ends;
    uint32_t triangle, side;
  };
  std::vector<Edge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    for (uint32_t side = 0; side < 3; ++side) {
      edges.push_back({std::minmax(mesh.triangles[t][side], mesh.triangles[t][(side + 1) % 3]), t, side});
    }
  }
  std::stable_sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) { return a.ends < b.ends; });
  std::vector<std::array<uint32_t, 3>> beside(mesh.triangles.size(), {kNobody, kNobody, kNobody});
  for (size_t i = 0; i + 1 < edges.size(); ++i) {
    const Edge &a = edges[i], &b = edges[i + 1];
    if (a.ends != b.ends) continue;
    beside[a.triangle][a.side] = b.triangle, beside[b.triangle][b.side] = a.triangle;
    ++i;
  }
  return beside;
}

/// Projects onto the plane of a normal, with the longest extent along x.
void LayOut(const TriangleMesh& mesh, const Eigen::Vector3f& normal, Chart* chart) {
  const Eigen::Vector3f u = normal.unitOrthogonal(), v = normal.cross(u), origin = mesh.positions[chart->vertices[0]];
  Eigen::Vector2f mean = Eigen::Vector2f::Zero();
  for (const uint32_t vertex : chart->vertices) {
    const Eigen::Vector3f at = mesh.positions[vertex] - origin;
    chart->places.emplace_back(u.dot(at), v.dot(at));
    mean += chart->places.back() / static_cast<float>(chart->vertices.size());
  }
  Eigen::Matrix2f spread = Eigen::Matrix2f::Zero();
  for (const Eigen::Vector2f& place : chart->places) spread += (place - mean) * (place - mean).transpose();
  const float angle = std::atan2(2 * spread(0, 1), spread(0, 0) - spread(1, 1)) / 2;
  const Eigen::Matrix2f turn = Eigen::Rotation2Df(-angle).toRotationMatrix();
  Eigen::Vector2f low = turn * chart->places[0], high = low;
  for (Eigen::Vector2f& place : chart->places) {
    place = turn * place;
    low = low.cwiseMin(place), high = high.cwiseMax(place);
  }
  for (Eigen::Vector2f& place : chart->places) place -= low;
  chart->size = high - low;
}

}  // namespace

std::vector<Chart> ChartsOf(const TriangleMesh& mesh) {
  const std::vector<std::array<uint32_t, 3>> beside = TrianglesBeside(mesh);
  std::vector<uint8_t> taken(mesh.triangles.size());
  std::vector<std::pair<uint32_t, uint32_t>> name(mesh.positions.size(), {kNobody, 0});  // chart, index in it
  std::vector<Chart> charts;
  std::vector<uint32_t> members;
  for (uint32_t first = 0; first < mesh.triangles.size(); ++first) {
    if (taken[first] != 0) continue;
    Eigen::Vector3f normal = NormalTimesArea(mesh, first);
    const auto& t = mesh.triangles[first];
    const Eigen::Vector3f smooth = mesh.normals[t[0]] + mesh.normals[t[1]] + mesh.normals[t[2]];
    if (normal.dot(smooth) >= kMinTurnCosine * normal.norm() * smooth.norm()) normal = smooth;
    normal = normal.norm() > 0 ? normal.normalized() : Eigen::Vector3f::UnitZ();
    members = {first};
    taken[first] = 1;
    for (size_t i = 0; i < members.size(); ++i) {
      for (const uint32_t other : beside[members[i]]) {
        if (other == kNobody || taken[other] != 0 || members.size() >= kMaxChartTriangles) continue;
        const Eigen::Vector3f its = NormalTimesArea(mesh, other);
        if (its.dot(normal) < kMinTurnCosine * its.norm()) continue;
        taken[other] = 1;
        members.push_back(other);
      }
    }
    const auto index = static_cast<uint32_t>(charts.size());
    Chart& chart = charts.emplace_back();
    for (const uint32_t member : members) {
      std::array<uint32_t, 3>& corners = chart.corners.emplace_back();
      for (size_t k = 0; k < 3; ++k) {
        const uint32_t vertex = mesh.triangles[member][k];
        if (name[vertex].first != index) {
          name[vertex] = {index, static_cast<uint32_t>(chart.vertices.size())};
          chart.vertices.push_back(vertex);
        }
        corners[k] = name[vertex].second;
      }
    }
    LayOut(mesh, normal, &chart);
  }
  return charts;
}

}  // namespace oraclegs
