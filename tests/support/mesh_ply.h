#pragma once

#include <cstring>
#include <string>

#include "oraclegs/core/files.h"
#include "oraclegs/mesh/triangle_mesh.h"

namespace oraclegs {

/// Reads a whole .ply that WriteMesh wrote.
inline TriangleMesh ReadMeshPly(const std::filesystem::path& path) {
  const std::string bytes = ReadFile(path);
  const auto after = [&](const std::string& word) { return bytes.find(word) + word.size(); };
  TriangleMesh mesh;
  mesh.positions.resize(std::stoull(bytes.substr(after("element vertex "))));
  mesh.normals.resize(mesh.positions.size()), mesh.colors.resize(mesh.positions.size());
  mesh.triangles.resize(std::stoull(bytes.substr(after("element face "))));
  const char* at = bytes.data() + after("end_header\n");
  const auto take = [&](void* to, size_t size) {
    std::memcpy(to, at, size);
    at += size;
  };
  for (size_t i = 0; i < mesh.positions.size(); ++i) {
    take(mesh.positions[i].data(), 12);
    take(mesh.normals[i].data(), 12);
    take(mesh.colors[i].data(), 3);
  }
  for (auto& triangle : mesh.triangles) {
    ++at;  // the number of corners
    take(triangle.data(), 12);
  }
  return mesh;
}

}  // namespace oraclegs
