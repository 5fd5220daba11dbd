#include "oraclegs/mesh/obj_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "oraclegs/core/files.h"
#include "oraclegs/image/codecs.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TriangleMesh Triangle() {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1.5f, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  SetNormals(&mesh);
  return mesh;
}

TEST(ObjFile, HasColorsBehindPositions) {
  const TempDir dir;
  TriangleMesh mesh = Triangle();
  mesh.colors = {{255, 0, 0}, {0, 255, 0}, {51, 0, 255}};
  EXPECT_THAT(WriteMesh(dir / "a.obj", mesh, {0, 0, 1}, {"note"}), ElementsAre(dir / "a.obj"));
  EXPECT_EQ(ReadFile(dir / "a.obj"),
            "# oraclegs mesh\n# note\n"
            "v 0 0 0 1.0000 0.0000 0.0000\nv 1.5 0 0 0.0000 1.0000 0.0000\nv 0 1 0 0.2000 0.0000 1.0000\n"
            "vn 0.0000 0.0000 1.0000\nvn 0.0000 0.0000 1.0000\nvn 0.0000 0.0000 1.0000\n"
            "f 1//1 2//2 3//3\n");
}

TEST(ObjFile, NamesMaterialAndTextureBesideIt) {
  const TempDir dir;
  TriangleMesh mesh = Triangle();
  mesh.texcoords = {{0, 0}, {1, 0}, {0.25f, 0.75f}};
  mesh.texture = {1, 1, 3, {10, 20, 30}};
  EXPECT_THAT(WriteMesh(dir / "a b.obj", mesh, {0, 0, 1}),
              ElementsAre(dir / "a b_texture.png", dir / "a b.mtl", dir / "a b.obj"));
  const std::string text = ReadFile(dir / "a b.obj");
  EXPECT_THAT(text, HasSubstr("\nmtllib a b.mtl\n"));
  EXPECT_THAT(text, HasSubstr("\nvt 0.000000 1.000000\nvt 1.000000 1.000000\nvt 0.250000 0.250000\n"));
  EXPECT_THAT(text, HasSubstr("\nusemtl surface\nf 1/1/1 2/2/2 3/3/3\n"));
  EXPECT_THAT(ReadFile(dir / "a b.mtl"), HasSubstr("newmtl surface\n"));
  EXPECT_THAT(ReadFile(dir / "a b.mtl"), HasSubstr("\nmap_Kd a b_texture.png\n"));
  EXPECT_EQ(DecodePng(ReadFile(dir / "a b_texture.png"), "png").data, mesh.texture.data);
}

}  // namespace
}  // namespace oraclegs
