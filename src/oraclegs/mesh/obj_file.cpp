#include "oraclegs/mesh/obj_file.h"

#include <fmt/format.h>

#include <iterator>

#include "oraclegs/core/files.h"
#include "oraclegs/image/codecs.h"

namespace oraclegs {
namespace {

std::string ObjText(const TriangleMesh& mesh, const std::string& material, const std::vector<std::string>& comments) {
  std::string text = "# oraclegs mesh\n";
  auto out = std::back_inserter(text);
  for (const std::string& comment : comments) fmt::format_to(out, "# {}\n", comment);
  const bool textured = !mesh.texcoords.empty();
  if (textured) fmt::format_to(out, "mtllib {}\n", material);
  for (size_t i = 0; i < mesh.positions.size(); ++i) {
    const Eigen::Vector3f& p = mesh.positions[i];
    fmt::format_to(out, "v {} {} {}", p.x(), p.y(), p.z());
    if (!textured) {
      for (const uint8_t channel : mesh.colors[i]) fmt::format_to(out, " {:.4f}", channel / 255.0);
    }
    text += '\n';
  }
  // From the lower left corner here.
  for (const Eigen::Vector2f& t : mesh.texcoords) fmt::format_to(out, "vt {:.6f} {:.6f}\n", t.x(), 1 - t.y());
  for (const Eigen::Vector3f& n : mesh.normals) fmt::format_to(out, "vn {:.4f} {:.4f} {:.4f}\n", n.x(), n.y(), n.z());
  if (textured) text += "usemtl surface\n";
  for (const auto& t : mesh.triangles) {
    const uint32_t a = t[0] + 1, b = t[1] + 1, c = t[2] + 1;
    if (textured) {
      fmt::format_to(out, "f {0}/{0}/{0} {1}/{1}/{1} {2}/{2}/{2}\n", a, b, c);
    } else {
      fmt::format_to(out, "f {0}//{0} {1}//{1} {2}//{2}\n", a, b, c);
    }
  }
  return text;
}

}  // namespace

std::vector<std::filesystem::path> WriteObj(const std::filesystem::path& path, const TriangleMesh& mesh,
                                            const std::vector<std::string>& comments) {
  std::filesystem::path material = path, image = path;
  material.replace_extension(".mtl");
  image.replace_filename(path.stem().string() + "_texture.png");
  std::vector<std::filesystem::path> written;
  if (!mesh.texcoords.empty()) {
    WritePng(image, mesh.texture);
    WriteFileAtomically(material, fmt::format("newmtl surface\nillum 0\nKa 1 1 1\nKd 1 1 1\nKs 0 0 0\nmap_Kd {}\n",
                                              image.filename().string()));
    written = {image, material};
  }
  WriteFileAtomically(path, ObjText(mesh, material.filename().string(), comments));
  written.push_back(path);
  return written;
}

}  // namespace oraclegs
