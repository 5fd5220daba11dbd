#include "oraclegs/mesh/vertex_colors.h"

#include <gtest/gtest.h>

#include "mesh/views_of_shapes.h"

namespace oraclegs {
namespace {

TEST(VertexColors, AreThoseOfTheViewsThatSeeTheVertex) {
  TriangleMesh mesh;
  mesh.positions = {{0.1f, 0.1f, 0}, {0.1f, 0.1f, -1}, {0.2f, 0.1f, 0}, {50, 0, 0}};
  mesh.normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, -1}, {0, 0, 1}};
  VertexColors colors(mesh, 0.05);
  colors.Add(ViewOfShape(FloorAt(0), ShapeCamera({0, 0, 2}, {0, 0, 0})));
  const auto found = colors.Colors();
  EXPECT_EQ(found[0], (std::array<uint8_t, 3>{64, 128, 191}));
  const std::array<uint8_t, 3> gray = {128, 128, 128};
  EXPECT_EQ(found[1], gray) << "hidden below the floor";
  EXPECT_EQ(found[2], gray) << "seen from behind";
  EXPECT_EQ(found[3], gray) << "outside of the image";
}

}  // namespace
}  // namespace oraclegs
