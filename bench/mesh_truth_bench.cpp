// Distance of a mesh from the known surfaces that it shows. Prints a line.
//   scripts/demo.sh /tmp/demo && build/release/bin/oraclegs mesh /tmp/demo/run && build/release/bin/mesh_truth_bench
//   /tmp/demo/run/mesh.ply

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>

#include "oraclegs/core/rng.h"
#include "support/mesh_ply.h"
#include "support/shape_distance.h"

namespace oraclegs {
namespace {

constexpr int kSamples = 200'000;  // of the mesh's area

/// Points that are spread evenly over the area.
std::vector<Eigen::Vector3d> PointsOn(const TriangleMesh& mesh) {
  const auto corner = [&](size_t t, size_t k) { return mesh.positions[mesh.triangles[t][k]].cast<double>().eval(); };
  std::vector<double> until(mesh.triangles.size());
  double area = 0;
  for (size_t t = 0; t < until.size(); ++t) {
    area += (corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0)).norm();
    until[t] = area;
  }
  Rng rng(1, RandomStream::kInitialPoints);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < kSamples; ++i) {
    const auto t =
        static_cast<size_t>(std::upper_bound(until.begin(), until.end(), rng.Uniform(0, area)) - until.begin());
    const double r = std::sqrt(rng.Uniform(0, 1)), s = rng.Uniform(0, 1);
    points.push_back((1 - r) * corner(std::min(t, until.size() - 1), 0) +
                     r * (1 - s) * corner(std::min(t, until.size() - 1), 1) +
                     r * s * corner(std::min(t, until.size() - 1), 2));
  }
  return points;
}

/// The longest inner side of the room.
double ExtentOf(const std::vector<SceneObject>& objects) {
  double extent = 0;
  for (const SceneObject& object : objects) {
    if (object.shape.kind != ShapeKind::kRoom) continue;
    extent = 2 * std::max({object.shape.size.x, object.shape.size.y, object.shape.size.z});
  }
  return extent;
}

void Measure(const std::filesystem::path& file) {
  const TriangleMesh mesh = ReadMeshPly(file);
  const std::vector<SceneObject> objects = DemoWorld(DemoKind::kRoom).objects;
  std::vector<double> distances;
  for (const Eigen::Vector3d& p : PointsOn(mesh)) distances.push_back(DistanceToScene(objects, {p.x(), p.y(), p.z()}));
  std::sort(distances.begin(), distances.end());
  const double extent = ExtentOf(objects);
  const auto quantile = [&](double share) {
    return distances[static_cast<size_t>(share * static_cast<double>(distances.size() - 1))];
  };
  const auto text = [&](double share) {
    return fmt::format("{:.4f} ({:.3f} %)", quantile(share), 100 * quantile(share) / extent);
  };
  std::printf("%s\n",
              fmt::format("{} vertices, {} triangles; distance to the truth, scene units (of the extent, {:.2f}): "
                          "median {}, 90 % below {}, 99 % below {}",
                          mesh.positions.size(), mesh.triangles.size(), extent, text(0.5), text(0.9), text(0.99))
                  .c_str());
}

}  // namespace
}  // namespace oraclegs

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: mesh_truth_bench MESH.ply of a demo scene\n");
    return 2;
  }
  try {
    oraclegs::Measure(argv[1]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "mesh_truth_bench: error: %s\n", error.what());
    return 3;
  }
}
