#include "oraclegs/mesh/triangle_mesh.h"

#include <Eigen/Geometry>
#include <bit>
#include <cmath>
#include <nlohmann/json.hpp>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/mesh/obj_file.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
static_assert(std::endian::native == std::endian::little, "numbers are written as the machine stores them");

constexpr int kTextureQuality = 95;                         // of a .glb's JPEG
constexpr size_t kPlyVertexBytes = 27, kPlyFaceBytes = 13;  // 6 floats and RGB; a count and 3 indices
constexpr const char* kPlyHeader =
    "ply\nformat binary_little_endian 1.0\ncomment oraclegs mesh\n{}element vertex {}\n"
    "property float x\nproperty float y\nproperty float z\n"
    "property float nx\nproperty float ny\nproperty float nz\n"
    "property uchar red\nproperty uchar green\nproperty uchar blue\n"
    "element face {}\nproperty list uchar int vertex_indices\nend_header\n";

template <class T>
void Put(std::string* bytes, const T& value) {
  bytes->append(reinterpret_cast<const char*>(&value), sizeof(T));
}

std::string PlyBytes(const TriangleMesh& mesh, const std::vector<std::string>& comments) {
  std::string lines;
  for (const std::string& comment : comments) lines += "comment " + comment + "\n";
  std::string bytes = fmt::format(fmt::runtime(kPlyHeader), lines, mesh.positions.size(), mesh.triangles.size());
  bytes.reserve(bytes.size() + mesh.positions.size() * kPlyVertexBytes + mesh.triangles.size() * kPlyFaceBytes);
  for (size_t i = 0; i < mesh.positions.size(); ++i) {
    for (int c = 0; c < 3; ++c) Put(&bytes, mesh.positions[i][c]);
    for (int c = 0; c < 3; ++c) Put(&bytes, mesh.normals[i][c]);
    Put(&bytes, mesh.colors[i]);
  }
  for (const auto& triangle : mesh.triangles) {
    Put(&bytes, uint8_t{3});
    Put(&bytes, triangle);
  }
  return bytes;
}

/// glTF multiplies with linear colors; 16 bits, because 8 of them do not distinguish dark sRGB values.
uint16_t LinearOfSrgb(uint8_t value) {
  const double v = value / 255.0;
  const double linear = v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
  return static_cast<uint16_t>(std::lround(65535 * linear));
}

enum GltfNumber { kGltfFloat = 5126, kGltfUnsignedShort = 5123, kGltfUnsignedInt = 5125 };

/// Views and accessors of a binary buffer.
class GltfBuffer {
 public:
  /// Adds the accessor of the bytes appended since the last call. `target`: 34962 vertices, 34963 indices.
  nlohmann::json& Add(size_t count, GltfNumber number, const char* type, int target) {
    views_.push_back(
        {{"buffer", 0}, {"byteOffset", begin_}, {"byteLength", bytes_.size() - begin_}, {"target", target}});
    accessors_.push_back(
        {{"bufferView", views_.size() - 1}, {"componentType", number}, {"count", count}, {"type", type}});
    begin_ = bytes_.size();
    return accessors_.back();
  }
  /// Adds a file; returns the index of its view.
  size_t AddFile(const std::string& file) {
    views_.push_back({{"buffer", 0}, {"byteOffset", begin_}, {"byteLength", file.size()}});
    bytes_ += file;
    bytes_.resize((bytes_.size() + 3) / 4 * 4);
    begin_ = bytes_.size();
    return views_.size() - 1;
  }
  std::string* bytes() { return &bytes_; }
  const nlohmann::json& views() const { return views_; }
  const nlohmann::json& accessors() const { return accessors_; }

 private:
  std::string bytes_;
  size_t begin_ = 0;
  nlohmann::json views_ = nlohmann::json::array(), accessors_ = nlohmann::json::array();
};

/// Adds the accessors 0 position, 1 normal, 2 color or place in the texture, 3 indices.
void PutGeometry(const TriangleMesh& mesh, GltfBuffer* buffer) {
  Eigen::Vector3f low = mesh.positions.front(), high = low;
  for (const Eigen::Vector3f& position : mesh.positions) {
    low = low.cwiseMin(position), high = high.cwiseMax(position);
    for (int c = 0; c < 3; ++c) Put(buffer->bytes(), position[c]);
  }
  nlohmann::json& positions = buffer->Add(mesh.positions.size(), kGltfFloat, "VEC3", 34962);
  positions["min"] = {low.x(), low.y(), low.z()};
  positions["max"] = {high.x(), high.y(), high.z()};
  for (const Eigen::Vector3f& normal : mesh.normals) {
    for (int c = 0; c < 3; ++c) Put(buffer->bytes(), normal[c]);
  }
  buffer->Add(mesh.normals.size(), kGltfFloat, "VEC3", 34962);
  for (const auto& color : mesh.colors) {
    for (const uint8_t channel : color) Put(buffer->bytes(), LinearOfSrgb(channel));
    Put(buffer->bytes(), uint16_t{65535});
  }
  for (const Eigen::Vector2f& place : mesh.texcoords) {
    for (int c = 0; c < 2; ++c) Put(buffer->bytes(), place[c]);
  }
  if (mesh.texcoords.empty()) {
    buffer->Add(mesh.colors.size(), kGltfUnsignedShort, "VEC4", 34962)["normalized"] = true;
  } else {
    buffer->Add(mesh.texcoords.size(), kGltfFloat, "VEC2", 34962);
  }
  for (const auto& triangle : mesh.triangles) Put(buffer->bytes(), triangle);
  buffer->Add(3 * mesh.triangles.size(), kGltfUnsignedInt, "SCALAR", 34963);
}

/// Adds the texture of the one material.
void PutTexture(const Image8& texture, GltfBuffer* buffer, nlohmann::json* document) {
  constexpr int kLinear = 9729, kClampToEdge = 33071;  // no smaller levels, in which charts would mix
  const size_t view = buffer->AddFile(CompressJpeg(texture, kTextureQuality));
  (*document)["images"] = {{{"bufferView", view}, {"mimeType", "image/jpeg"}}};
  (*document)["samplers"] = {
      {{"magFilter", kLinear}, {"minFilter", kLinear}, {"wrapS", kClampToEdge}, {"wrapT", kClampToEdge}}};
  (*document)["textures"] = {{{"source", 0}, {"sampler", 0}}};
  (*document)["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", 0}};
}

std::string GlbBytes(const TriangleMesh& mesh, const Eigen::Vector3d& up, const std::vector<std::string>& comments,
                     const fs::path& path) {
  GltfBuffer buffer;
  PutGeometry(mesh, &buffer);
  const auto turn = Eigen::Quaterniond::FromTwoVectors(up, Eigen::Vector3d::UnitY());
  const nlohmann::json primitive = {
      {"attributes", {{"POSITION", 0}, {"NORMAL", 1}, {mesh.texcoords.empty() ? "COLOR_0" : "TEXCOORD_0", 2}}},
      {"indices", 3},
      {"material", 0},
      {"mode", 4}};
  nlohmann::json document = {{"asset", {{"version", "2.0"}, {"generator", "oraclegs"}}},
                             {"extensionsUsed", {"KHR_materials_unlit"}},
                             {"scene", 0},
                             {"scenes", {{{"nodes", {0}}}}},
                             {"nodes", {{{"mesh", 0}, {"rotation", {turn.x(), turn.y(), turn.z(), turn.w()}}}}},
                             {"meshes", {{{"primitives", nlohmann::json::array({primitive})}}}},
                             {"materials",
                              {{{"doubleSided", true},
                                {"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 1}}},
                                {"extensions", {{"KHR_materials_unlit", nlohmann::json::object()}}}}}}};
  if (!mesh.texcoords.empty()) PutTexture(mesh.texture, &buffer, &document);
  document["buffers"] = {{{"byteLength", buffer.bytes()->size()}}};
  document["bufferViews"] = buffer.views();
  document["accessors"] = buffer.accessors();
  if (!comments.empty()) document["asset"]["extras"] = {{"comments", comments}};
  std::string text = document.dump();
  while (text.size() % 4 != 0) text += ' ';
  constexpr uint64_t kHeaders = 12 + 8 + 8;
  const uint64_t length = kHeaders + text.size() + buffer.bytes()->size();
  if (length > UINT32_MAX) {
    throw UsageError("{}: the mesh needs {:.1f} GiB, a .glb holds 4; write a .ply, or give a larger --voxel",
                     path.string(), static_cast<double>(length) / (1 << 30));
  }
  std::string bytes;
  bytes.reserve(length);
  bytes += "glTF";
  Put(&bytes, uint32_t{2});
  Put(&bytes, static_cast<uint32_t>(length));
  Put(&bytes, static_cast<uint32_t>(text.size()));
  bytes += "JSON" + text;
  Put(&bytes, static_cast<uint32_t>(buffer.bytes()->size()));
  bytes += std::string("BIN\0", 4) + *buffer.bytes();
  return bytes;
}

}  // namespace

void RequireMeshExtension(const fs::path& path) {
  const fs::path extension = path.extension();
  if (extension == ".ply" || extension == ".glb" || extension == ".obj") return;
  throw UsageError("{}: a mesh is written as .ply, .glb or .obj; give a name that ends so", path.string());
}

bool HoldsTexture(const fs::path& path) { return path.extension() != ".ply"; }

std::vector<fs::path> WriteMesh(const fs::path& path, const TriangleMesh& mesh, const Eigen::Vector3d& up,
                                const std::vector<std::string>& comments) {
  RequireMeshExtension(path);
  const bool textured = HoldsTexture(path) && !mesh.texcoords.empty();
  if (mesh.triangles.empty() || mesh.normals.size() != mesh.positions.size() ||
      (textured ? mesh.texcoords.size() : mesh.colors.size()) != mesh.positions.size()) {
    throw ShapeError("WriteMesh: {} triangles, {} positions, {} normals, {} colors, {} texture coordinates",
                     mesh.triangles.size(), mesh.positions.size(), mesh.normals.size(), mesh.colors.size(),
                     mesh.texcoords.size());
  }
  if (path.extension() == ".obj") return WriteObj(path, mesh, comments);
  WriteFileAtomically(path, path.extension() == ".glb" ? GlbBytes(mesh, up, comments, path) : PlyBytes(mesh, comments));
  return {path};
}

}  // namespace oraclegs
