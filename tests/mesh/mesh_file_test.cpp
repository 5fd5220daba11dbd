#include "oraclegs/mesh/triangle_mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "oraclegs/core/files.h"
#include "oraclegs/image/codecs.h"
#include "support/errors.h"
#include "support/mesh_ply.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;

TriangleMesh Tetrahedron() {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  mesh.colors = {{0, 128, 255}, {1, 2, 3}, {4, 5, 6}, {7, 8, 9}};
  SetNormals(&mesh);
  return mesh;
}

TEST(MeshFile, PlyComesBack) {
  const TempDir dir;
  const TriangleMesh mesh = Tetrahedron();
  WriteMesh(dir / "mesh.ply", mesh, {0, 0, 1});
  const TriangleMesh read = ReadMeshPly(dir / "mesh.ply");
  EXPECT_EQ(read.positions, mesh.positions);
  EXPECT_EQ(read.normals, mesh.normals);
  EXPECT_EQ(read.colors, mesh.colors);
  EXPECT_EQ(read.triangles, mesh.triangles);
}

TEST(MeshFile, GlbHoldsTheGeometryWithUpAlongY) {
  const TempDir dir;
  WriteMesh(dir / "mesh.glb", Tetrahedron(), {0, 0, 1});
  const std::string bytes = ReadFile(dir / "mesh.glb");
  const auto number = [&](size_t at) {
    uint32_t value;
    std::memcpy(&value, bytes.data() + at, 4);
    return value;
  };
  ASSERT_EQ(bytes.substr(0, 4), "glTF");
  EXPECT_EQ(number(8), bytes.size());
  const uint32_t text = number(12);
  const auto json = nlohmann::json::parse(bytes.substr(20, text));
  EXPECT_EQ(number(20 + text), json["buffers"][0]["byteLength"]);
  EXPECT_EQ(28 + text + json["buffers"][0]["byteLength"].get<size_t>(), bytes.size());
  EXPECT_EQ(json["accessors"][0]["max"], (std::vector<float>{1, 1, 1}));
  EXPECT_EQ(json["accessors"][3]["count"], 12);
  EXPECT_EQ(json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"], 2);
  const auto turn = json["nodes"][0]["rotation"].get<std::vector<double>>();
  const Eigen::Quaterniond rotation(turn[3], turn[0], turn[1], turn[2]);
  EXPECT_TRUE((rotation * Eigen::Vector3d::UnitZ()).isApprox(Eigen::Vector3d::UnitY(), 1e-9));
  const size_t colors = 28 + text + json["bufferViews"][2]["byteOffset"].get<size_t>();
  uint16_t rgba[4];
  std::memcpy(rgba, bytes.data() + colors, 8);
  EXPECT_EQ(rgba[0], 0);
  EXPECT_NEAR(rgba[1] / 65535.0, 0.2159, 1e-3) << "sRGB 128, linear";
  EXPECT_EQ(rgba[2], 65535);
}

TEST(MeshFile, GlbHoldsATexture) {
  const TempDir dir;
  TriangleMesh mesh = Tetrahedron();
  mesh.texcoords = {{0, 0}, {1, 0}, {0, 1}, {1, 1}};
  mesh.texture = {8, 8, 3, std::vector<uint8_t>(192, 200)};
  WriteMesh(dir / "mesh.glb", mesh, {0, 0, 1});
  const std::string bytes = ReadFile(dir / "mesh.glb");
  uint32_t text;
  std::memcpy(&text, bytes.data() + 12, 4);
  const auto json = nlohmann::json::parse(bytes.substr(20, text));
  EXPECT_EQ(json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"], 2);
  EXPECT_EQ(json["accessors"][2]["type"], "VEC2");
  EXPECT_EQ(json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"], 0);
  EXPECT_EQ(json["textures"][0]["source"], 0);
  EXPECT_EQ(json["samplers"][0]["minFilter"], 9729);
  const auto& view = json["bufferViews"][json["images"][0]["bufferView"].get<size_t>()];
  const std::string jpeg = bytes.substr(28 + text + view["byteOffset"].get<size_t>(), view["byteLength"]);
  const Image8 image = DecodeJpeg(jpeg, "jpeg", Orientation::kAsStored);
  EXPECT_EQ(image.width, 8);
  EXPECT_NEAR(image.data[0], 200, 2);
  EXPECT_EQ(bytes.size() % 4, 0u);
  EXPECT_EQ(28 + text + json["buffers"][0]["byteLength"].get<size_t>(), bytes.size());
}

TEST(MeshFile, OtherExtensionsAreRefused) {
  EXPECT_THAT(MessageOf<UsageError>([] {
                WriteMesh("mesh.stl", Tetrahedron(), {0, 0, 1});
              }),
              HasSubstr(".glb or .obj"));
  EXPECT_THROW(WriteMesh("mesh.ply", {}, {0, 0, 1}), ShapeError);
}

}  // namespace
}  // namespace oraclegs
