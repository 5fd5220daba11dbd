#include "bench/parser_inputs.h"

#include <unistd.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "formats/glb_edit.h"
#include "oraclegs/capture/zip_photos.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/safetensors.h"
#include "oraclegs/core/shard_index.h"
#include "oraclegs/core/unique_json.h"
#include "oraclegs/formats/compressed_ply.h"
#include "oraclegs/formats/gltf_reader.h"
#include "oraclegs/formats/gltf_writer.h"
#include "oraclegs/formats/gzip.h"
#include "oraclegs/formats/sog_reader.h"
#include "oraclegs/formats/sog_writer.h"
#include "oraclegs/formats/splat.h"
#include "oraclegs/formats/spz.h"
#include "oraclegs/formats/zip_archive.h"
#include "oraclegs/gaussians/ply.h"
#include "oraclegs/image/exif.h"
#include "oraclegs/image/exif_tags.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/scene/colmap_binary.h"
#include "oraclegs/scene/colmap_text.h"
#include "oraclegs/scene/transforms.h"
#include "oraclegs/weights/checkpoint/state_dict.h"
#include "oraclegs/weights/checkpoint/torch_file.h"
#include "weights/checkpoint/torch_bytes.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
namespace torch = torch_bytes;

/// A temporary folder, removed when the program ends.
class BenchFolder {
 public:
  BenchFolder() : path_(fs::temp_directory_path() / ("parser_growth_" + std::to_string(getpid()))) {
    fs::create_directories(path_);
  }
  ~BenchFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  BenchFolder(const BenchFolder&) = delete;
  BenchFolder& operator=(const BenchFolder&) = delete;

  fs::path Put(const std::string& name, const std::string& bytes) const {
    ReplaceFile(path_ / name, bytes);
    return path_ / name;
  }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

const BenchFolder& Folder() {
  static const BenchFolder folder;
  return folder;
}

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

std::string Numbered(const char* before, size_t i, const char* after) { return before + std::to_string(i) + after; }

std::string GltfWith(const std::function<void(nlohmann::json*)>& edit) {
  return EditGlb(EncodeGltf(MadeGaussians(5), 0), [&](nlohmann::json& json) { edit(&json); });
}

std::string Safetensors(const std::string& header, const std::string& data) {
  return torch::Bytes(header.size(), 8) + header + data;
}

void ReadTorch(const std::string& file) {
  PickleHeap heap;
  heap.file = "f";
  FindStateDict(ReadTorchFile(file, &heap), "", heap);
}

std::string TorchZip(const std::string& pickle) { return torch::Zip({{"a/data.pkl", torch::Pickle(pickle)}}); }

std::string Colmap(uint64_t count) { return torch::Bytes(count, 8); }

}  // namespace

std::string Repeated(size_t bytes, const std::function<std::string(size_t)>& piece) {
  std::string all;
  for (size_t i = 0; all.size() < bytes; ++i) all += piece(i);
  return all;
}

std::vector<ParserInput> SplatInputs() {
  const auto ply = [](const std::string& file) { DecodeGaussianPly(file, "f"); };
  const auto gltf = [](const std::string& file) { DecodeGltf(file, "f"); };
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
      {"sog", "usual", [](size_t bytes) { return EncodeSog(MadeGaussians(bytes / 14), 0); }, sog},
      {"sog", "many files of one name",
       [](size_t bytes) {
         std::vector<std::pair<std::string, std::string>> files;
         for (size_t i = 0; i < bytes / 110; ++i) files.emplace_back(Numbered("a", i, ""), "");
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

std::vector<ParserInput> SceneInputs() {
  const auto images_text = [](const std::string& file) { ParseImagesText(file, "f"); };
  const auto images_binary = [](const std::string& file) { ParseImagesBinary(file, "f"); };
  const auto transforms = [](const std::string& file) {
    Folder().Put("transforms.json", file);
    ReadTransformsScene(Folder().path(), SceneReadOptions{}, Silent());
  };
  const auto frames = [](size_t bytes, bool equal) {
    return R"({"camera_angle_x":1,"w":4,"h":3,"frames":[)" +
           Repeated(bytes,
                    [equal](size_t i) {
                      return (i == 0 ? "" : ",") + std::string(R"({"file_path":"a)") +
                             (equal ? "" : std::to_string(i)) +
                             R"(.png","transform_matrix":[[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]})";
                    }) +
           "]}";
  };
  const std::string pose(56, '\0');
  return {
      {"colmap text", "points",
       [](size_t bytes) {
         return Repeated(bytes, [](size_t i) { return Numbered("", i + 1, " 1.5 2.5 3.5 200 100 50 0.5 1 7 2 8\n"); });
       },
       [](const std::string& file) { ParsePointsText(file, "f"); }},
      {"colmap text", "one long track",
       [](size_t bytes) { return "1 1 2 3 200 100 50 0.5" + Repeated(bytes, [](size_t) { return " 1 7"; }) + "\n"; },
       [](const std::string& file) { ParsePointsText(file, "f"); }},
      {"colmap text", "many images",
       [](size_t bytes) {
         return Repeated(bytes, [](size_t i) {
           return std::to_string(i + 1) + " 1 0 0 0 1 2 3 1 " + Numbered("a", i, ".jpg\n1 2 3\n");
         });
       },
       images_text},
      {"colmap text", "images of one name",
       [](size_t bytes) {
         return Repeated(bytes, [](size_t i) { return std::to_string(i + 1) + " 1 0 0 0 1 2 3 1 a.jpg\n1 2 3\n"; });
       },
       images_text},
      {"colmap text", "one image of many points",
       [](size_t bytes) {
         return "1 1 0 0 0 1 2 3 1 a.jpg\n" + Repeated(bytes, [](size_t i) { return Numbered("1.5 2.5 ", i, " "); }) +
                "\n";
       },
       images_text},
      {"colmap text", "many cameras",
       [](size_t bytes) {
         return Repeated(bytes, [](size_t i) { return Numbered("", i + 1, " PINHOLE 400 300 500 500 200 150\n"); });
       },
       [](const std::string& file) { ParseCamerasText(file, "f"); }},
      {"colmap binary", "points",
       [](size_t bytes) {
         const size_t n = bytes / 67;
         std::string file = Colmap(n);
         for (size_t i = 0; i < n; ++i) {
           file += torch::Bytes(i + 1, 8) + std::string(24 + 3 + 8, '\0') + Colmap(2) + std::string(16, '\0');
         }
         return file;
       },
       [](const std::string& file) { ParsePointsBinary(file, "f"); }},
      {"colmap binary", "many images",
       [pose](size_t bytes) {
         const size_t n = bytes / 78;
         std::string file = Colmap(n);
         for (size_t i = 0; i < n; ++i) {
           std::string rotated = pose;
           rotated[6] = '\xf0', rotated[7] = '\x3f';  // 1.0
           file += torch::Bytes(i + 1, 4) + rotated + torch::Bytes(1, 4) + Numbered("a", i, "") + '\0' + Colmap(0);
         }
         return file;
       },
       images_binary},
      {"colmap binary", "one long name",
       [pose](size_t bytes) {
         return Colmap(1) + torch::Bytes(1, 4) + pose + torch::Bytes(1, 4) + std::string(bytes, 'a');
       },
       images_binary},
      {"transforms", "many frames", [frames](size_t bytes) { return frames(bytes, false); }, transforms},
      {"transforms", "frames of one image", [frames](size_t bytes) { return frames(bytes, true); }, transforms},
  };
}

std::vector<ParserInput> OtherInputs() {
  const auto safetensors = [](const std::string& file) { SafetensorsFile::Parse(file, "f"); };
  const auto photos = [](const std::string& file) {
    const fs::path archive = Folder().Put("a.zip", file);
    if (IsZip(archive) && CountZipPhotos(archive) > 0) UnpackPhotos(archive, Folder().path() / "photos", Silent());
  };
  const auto zip = [](size_t bytes, bool equal) {
    std::vector<std::pair<std::string, std::string>> files;
    const size_t n = std::min<size_t>(bytes / 110, 60000);
    for (size_t i = 0; i < n; ++i) files.emplace_back(Numbered("a", 100000 + i, ".jpg"), "");
    std::string archive = WriteZip(files);
    if (!equal) return archive;
    for (size_t at = archive.find("a1"); at != std::string::npos; at = archive.find("a1", at + 11)) {
      if (archive.compare(at + 7, 4, ".jpg") == 0) archive.replace(at, 11, "a100000.jpg");
    }
    return archive;
  };
  const auto info = [](const std::string& file) { ReadImageInfo(Folder().Put("a.img", file)); };
  const auto exif = [](const std::string& file) { ParseExif(file); };
  return {
      {"json", "many keys",
       [](size_t bytes) {
         return "{" + Repeated(bytes, [](size_t i) { return Numbered("\"k", i, "\":0,"); }) + "\"z\":0}";
       },
       [](const std::string& file) { ParseUniqueJson(file, "f", "f"); }},
      {"json", "many arrays", [](size_t bytes) { return "[" + Repeated(bytes, [](size_t) { return "[],"; }) + "0]"; },
       [](const std::string& file) { ParseUniqueJson(file, "f", "f"); }},
      {"safetensors", "many tensors",
       [](size_t bytes) {
         size_t count = 0;
         const std::string list = Repeated(bytes, [&](size_t i) {
           ++count;
           return (i == 0 ? "" : ",") + Numbered("\"t", i, "\":{\"dtype\":\"U8\",\"shape\":[1],\"data_offsets\":[") +
                  std::to_string(i) + "," + std::to_string(i + 1) + "]}";
         });
         return Safetensors("{" + list + "}", std::string(count, 'x'));
       },
       safetensors},
      {"safetensors", "one large tensor",
       [](size_t bytes) {
         const std::string n = std::to_string(bytes);
         return Safetensors(R"({"t":{"dtype":"U8","shape":[)" + n + R"(],"data_offsets":[0,)" + n + "]}}",
                            std::string(bytes, 'x'));
       },
       safetensors},
      {"safetensors", "one long shape",
       [](size_t bytes) {
         return Safetensors(R"({"t":{"dtype":"U8","shape":[)" + Repeated(bytes, [](size_t) { return "1,"; }) +
                                R"(1],"data_offsets":[0,1]}})",
                            "x");
       },
       safetensors},
      {"shard index", "many names",
       [](size_t bytes) {
         return "{\"weight_map\":{" +
                Repeated(bytes, [](size_t i) { return Numbered("\"t", i, "\":\"x-1.safetensors\","); }) +
                "\"z\":\"x-1.safetensors\"}}";
       },
       [](const std::string& file) { ReadShardIndex(Folder().Put("x.safetensors.index.json", file)); }},
      {"pickle", "many tensors",
       [](size_t bytes) {
         std::vector<std::pair<std::string, std::string>> items;
         for (size_t i = 0; i < bytes / 180; ++i) {
           items.emplace_back(Numbered("t", i, ".weight"), torch::Tensor(torch::Storage("0", 1), {{1}, {1}}));
         }
         return torch::Zip({{"a/data.pkl", torch::Pickle(torch::Dict(items))}, {"a/data/0", "1234"}});
       },
       ReadTorch},
      {"pickle", "many storages",
       [](size_t bytes) {
         std::vector<std::pair<std::string, std::string>> items, none;
         std::map<std::string, std::string> files;
         for (size_t i = 0; i < bytes / 300; ++i) {
           const std::string key = std::to_string(i);
           items.emplace_back("t" + key, torch::Tensor(torch::Storage(key, 1), {{1}, {1}}));
           files["a/data/" + key] = "1234";
         }
         files["a/data.pkl"] = torch::Pickle(torch::Dict(items));
         return torch::Zip({files.begin(), files.end()});
       },
       ReadTorch},
      {"pickle", "one name again",
       [](size_t bytes) {
         std::vector<std::pair<std::string, std::string>> items;
         for (size_t i = 0; i < bytes / 180; ++i) {
           items.emplace_back("t.weight", torch::Tensor(torch::Storage("0", 1), {{1}, {1}}));
         }
         return torch::Zip({{"a/data.pkl", torch::Pickle(torch::Dict(items))}, {"a/data/0", "1234"}});
       },
       ReadTorch},
      {"pickle", "nested tuples", [](size_t bytes) { return TorchZip("N" + std::string(bytes, '\x85')); }, ReadTorch},
      {"pickle", "copies of one text",
       [](size_t bytes) { return TorchZip("](" + torch::Text("a") + std::string(bytes, '2') + "e"); }, ReadTorch},
      {"pickle", "marks", [](size_t bytes) { return TorchZip(std::string(bytes, '(') + std::string(bytes, 't')); },
       ReadTorch},
      {"pickle", "appends to one list",
       [](size_t bytes) { return TorchZip("]" + Repeated(bytes, [](size_t) { return "Na"; })); }, ReadTorch},
      {"pickle", "many names of Python's",
       [](size_t bytes) {
         return TorchZip("](" + Repeated(bytes, [](size_t i) { return torch::Global("m", Numbered("n", i, "")); }) +
                         "e");
       },
       ReadTorch},
      {"pickle", "dicts in dicts",
       [](size_t bytes) {
         const size_t n = bytes / 9;
         return TorchZip(Repeated(8 * n, [](size_t) { return "}(" + torch::Text("a"); }) + "}" + std::string(n, 'u'));
       },
       ReadTorch},
      {"photos in a zip", "of one name", [zip](size_t bytes) { return zip(bytes, true); }, photos},
      {"photos in a zip", "of many names", [zip](size_t bytes) { return zip(bytes, false); }, photos},
      {"exif", "many tags",
       [](size_t bytes) {
         const size_t n = std::min<size_t>(bytes / 12, 65535);
         return "II*" + std::string(1, '\0') + torch::Bytes(8, 4) + torch::Bytes(n, 2) +
                Repeated(n * 12,
                         [](size_t i) {
                           return torch::Bytes(0x8769 + i % 2, 2) + torch::Bytes(4, 2) + torch::Bytes(1, 4) +
                                  torch::Bytes(8, 4);
                         }) +
                torch::Bytes(8, 4);
       },
       exif},
      {"jpeg", "many segments",
       [](size_t bytes) {
         return "\xff\xd8" + Repeated(bytes, [](size_t) { return std::string("\xff\xe1\0\2", 4); }) + "\xff\xd9";
       },
       [](const std::string& file) {
         ReadJpegMetadata(file);
         ReadExif(file);
       }},
      {"jpeg", "many segments, size",
       [](size_t bytes) {
         return "\xff\xd8" + Repeated(bytes, [](size_t) { return std::string("\xff\xe1\0\2", 4); }) + "\xff\xd9";
       },
       info},
      {"png", "many chunks",
       [](size_t bytes) {
         return "\x89PNG\r\n\x1a\n" + Repeated(bytes, [](size_t) { return std::string("\0\0\0\0teXt\0\0\0\0", 12); });
       },
       [info](const std::string& file) {
         ReadExif(file);
         info(file);
       }},
      {"webp", "many chunks",
       [](size_t bytes) {
         return "RIFF" + torch::Bytes(bytes, 4) + "WEBP" +
                Repeated(bytes, [](size_t) { return std::string("ABCD\0\0\0\0", 8); });
       },
       [info](const std::string& file) {
         ReadExif(file);
         info(file);
       }},
  };
}

}  // namespace oraclegs
