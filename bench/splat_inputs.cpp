#include <functional>
#include <nlohmann/json.hpp>

#include "bench/parser_inputs.h"
#include "formats/glb_edit.h"
#include "formats/spz_version4.h"
#include "oraclegs/core/files.h"
#include "oraclegs/formats/codecs.h"
#include "oraclegs/formats/gzip.h"
#include "oraclegs/formats/zip_archive.h"
#include "oraclegs/gaussians/ply.h"

namespace oraclegs {
namespace {

constexpr const char* kUsdHead = "#usda 1.0\n";

Gaussians MadeGaussians(size_t n) {
  Gaussians g = Gaussians::Zeros(static_cast<int64_t>(std::max<size_t>(n, 1)));
  uint32_t state = 7;
  g.ForEach([&](const char*, Buffer<float>& part) {
    for (float& x : part.span()) {
      state = state * 1664525u + 1013904223u;
      x = static_cast<float>(state >> 8) * 0x1p-24f - 0.5f;
    }
  });
  return g;
}

std::string PlyHead(const std::string& format, size_t rows) {
  std::string head = "ply\nformat " + format + " 1.0\nelement vertex " + std::to_string(rows) + "\n";
  for (const char* name : {"x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0", "scale_1", "scale_2",
                           "rot_0", "rot_1", "rot_2", "rot_3"}) {
    head += std::string("property float ") + name + "\n";
  }
  return head;
}

std::string GltfWith(const std::function<void(nlohmann::json*)>& edit) {
  return EditGlb(EncodeGltf(MadeGaussians(5), 0), [&](nlohmann::json& json) { edit(&json); });
}

}  // namespace

std::vector<ParserInput> SplatInputs() {
  const auto ply = [](const std::string& file) { DecodeGaussianPly(file, "f"); };
  const auto gltf = [](const std::string& file) { DecodeGltf(file, "f"); };
  const auto usd = [](const std::string& file) { DecodeUsda(file, "f"); };
  const auto spz = [](const std::string& file) { DecodeSpz(file, "f"); };
  const auto sog = [](const std::string& file) { DecodeSog(file, "f"); };
  const auto nodes = [](size_t bytes) { return std::max<size_t>(bytes / 20, 2); };
  return {
      {"ply", "text",
       [](size_t bytes) {
         const size_t n = bytes / 70;
         std::string file = PlyHead("ascii", n) + "end_header\n";
         for (size_t i = 0; i < n; ++i) file += "0.1 0.2 -0.3 1 2 3 0.5 -4.1 -4.2 -4.3 1 0 0 0.125 \n";
         return file;
       },
       ply},
      {"ply", "binary", [](size_t bytes) { return EncodeGaussianPly(MadeGaussians(bytes / 248), 3, {}, {}); }, ply},
      {"ply", "many elements",
       [](size_t bytes) {
         return PlyHead("ascii", 1) + Repeated(bytes, [](size_t i) { return Numbered("element e", i, " 0\n"); }) +
                "end_header\n" + std::string(28, '1');
       },
       ply},
      {"ply", "many properties",
       [](size_t bytes) {
         return PlyHead("binary_little_endian", 1) +
                Repeated(bytes, [](size_t i) { return Numbered("property uchar p", i, "\n"); }) + "end_header\n" +
                std::string(56 + bytes / 15, '\0');
       },
       ply},
      {"ply", "many comments",
       [](size_t bytes) { return PlyHead("ascii", 1) + Repeated(bytes, [](size_t) { return "comment\n"; }); }, ply},
      {"ply", "rows of lists",
       [](size_t bytes) {
         return "ply\nformat binary_little_endian 1.0\nelement face " + std::to_string(bytes) +
                "\nproperty list uchar int v\n" + PlyHead("binary_little_endian", 1).substr(44) + "end_header\n" +
                std::string(bytes + 56, '\0');
       },
       ply},
      {"compressed ply", "usual", [](size_t bytes) { return EncodeCompressedPly(MadeGaussians(bytes / 16), 0, {}); },
       [](const std::string& file) { DecodeCompressedPly(file, "f"); }},
      {"compressed ply", "rows without columns",
       [](size_t bytes) {
         const std::string n = std::to_string(bytes / 256 * 256), chunks = std::to_string(bytes / 256);
         return "ply\nformat binary_little_endian 1.0\nelement chunk " + chunks +
                "\nproperty uchar a\nelement vertex " + n + "\nproperty uchar packed_position\nend_header\n" +
                std::string(bytes + bytes / 256, '\0');
       },
       [](const std::string& file) { DecodeCompressedPly(file, "f"); }},
      {"spz", "gzip", [](size_t bytes) { return EncodeSpz(MadeGaussians(bytes / 16), 0); }, spz},
      {"spz", "bare", [](size_t bytes) { return Gunzip(EncodeSpz(MadeGaussians(bytes / 65), 3), "f").Next(1 << 30); },
       spz},
      {"spz", "version 4", [](size_t bytes) { return SpzOfVersion4(EncodeSpz(MadeGaussians(bytes / 16), 0)); }, spz},
      {"spz", "version 4, harmonics",
       [](size_t bytes) { return SpzOfVersion4(EncodeSpz(MadeGaussians(bytes / 50), 3)); }, spz},
      {"sog", "usual", [](size_t bytes) { return EncodeSog(MadeGaussians(bytes / 14), 0); }, sog},
      {"sog", "many files of one name",
       [](size_t bytes) {
         std::vector<std::pair<std::string, std::string>> files;
         for (size_t i = 0; i <= bytes / 110; ++i) files.emplace_back(Numbered("a", i, ""), "");
         return WriteZip(files);
       },
       sog},
      {"sog", "many keys in meta.json",
       [](size_t bytes) {
         return WriteZip({{"meta.json", "{" + Repeated(bytes, [](size_t i) { return Numbered("\"k", i, "\":0,"); }) +
                                            "\"version\":2}"}});
       },
       sog},
      {".splat", "usual", [](size_t bytes) { return EncodeSplat(MadeGaussians(bytes / 32)); },
       [](const std::string& file) { DecodeSplat(file, "f"); }},
      {"gltf", "usual", [](size_t bytes) { return EncodeGltf(MadeGaussians(bytes / 64), 0); }, gltf},
      {"gltf", "spz", [](size_t bytes) { return EncodeGltfSpz(MadeGaussians(bytes / 16), 0); }, gltf},
      {"usd", "usual", [](size_t bytes) { return EncodeUsda(MadeGaussians(bytes / 180), 0); }, usd},
      {"usd", "archive", [](size_t bytes) { return EncodeUsdz(MadeGaussians(bytes / 700), 3); },
       [](const std::string& file) { DecodeUsdz(file, "f"); }},
      {"usd", "many prims",
       [](size_t bytes) { return kUsdHead + Repeated(bytes, [](size_t) { return "def\"\"{}\n"; }); }, usd},
      {"usd", "prims in prims",
       [](size_t bytes) {
         return kUsdHead + Repeated(bytes / 2, [](size_t) { return "def\"\"{uniform token[] xformOpOrder=[]\n"; }) +
                std::string(bytes / 80, '}');
       },
       usd},
      {"usd", "brackets in brackets",
       [](size_t bytes) {
         return kUsdHead + ("def\"\"{int a=" + std::string(bytes / 2, '[')) + std::string(bytes / 2, ']');
       },
       usd},
      {"usd", "many operations",
       [](size_t bytes) {
         return kUsdHead + ("def\"\"{float xformOp:rotateX = 1\ntoken[] xformOpOrder = [" +
                            Repeated(bytes, [](size_t) { return "\"xformOp:rotateX\","; }) + "]}");
       },
       usd},
      {"usd", "many splats",
       [](size_t bytes) {
         return kUsdHead + Repeated(bytes, [](size_t) {
                  return "def ParticleField3DGaussianSplat \"\" {\npoint3f[] positions = [(0,0,0)]\nquatf[] "
                         "orientations = [(1,0,0,0)]\nfloat3[] scales = [(1,1,1)]\nfloat[] opacities = [1]\nint "
                         "radiance:sphericalHarmonicsDegree = 0\nfloat3[] radiance:sphericalHarmonicsCoefficients = "
                         "[(0,0,0)]\n}\n";
                });
       },
       usd},
      {"gltf", "chain of nodes",
       [nodes](size_t bytes) {
         return GltfWith([n = nodes(bytes)](nlohmann::json* json) {
           for (size_t i = 1; i < n; ++i) (*json)["nodes"].push_back({{"children", {i + 1 < n ? i + 1 : 0}}});
           (*json)["scenes"][0]["nodes"] = {1};
         });
       },
       gltf},
      {"gltf", "many nodes",
       [](size_t bytes) {
         return GltfWith([n = bytes / 10](nlohmann::json* json) {
           for (size_t i = 1; i < n; ++i) {
             (*json)["nodes"].push_back(nlohmann::json::object());
             (*json)["scenes"][0]["nodes"].push_back(i);
           }
         });
       },
       gltf},
      {"gltf", "one node named again",
       [](size_t bytes) {
         return GltfWith([&](nlohmann::json* json) { (*json)["scenes"][0]["nodes"] = std::vector<int>(bytes / 2, 0); });
       },
       gltf},
      {"gltf", "many primitives",
       [](size_t bytes) {
         return GltfWith([n = bytes / 500](nlohmann::json* json) {
           nlohmann::json& list = (*json)["meshes"][0]["primitives"];
           const nlohmann::json first = list[0];
           for (size_t i = 0; i < n; ++i) list.push_back(first);
         });
       },
       gltf},
      {"gltf", "many meshes without Gaussians",
       [](size_t bytes) {
         return GltfWith([n = bytes / 34](nlohmann::json* json) {
           for (size_t i = 1; i < n; ++i) {
             (*json)["meshes"].push_back({{"primitives", {{{"mode", 0}}}}});
             (*json)["nodes"].push_back({{"mesh", i}});
             (*json)["scenes"][0]["nodes"].push_back(i);
           }
         });
       },
       gltf},
  };
}

}  // namespace oraclegs
