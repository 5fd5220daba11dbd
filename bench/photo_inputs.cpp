#include <zlib.h>

#include <algorithm>
#include <cmath>

#include "bench/parser_inputs.h"
#include "oraclegs/capture/video.h"
#include "oraclegs/capture/zip_photos.h"
#include "oraclegs/core/files.h"
#include "oraclegs/formats/zip_archive.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/image/exif.h"
#include "oraclegs/image/gpano.h"
#include "oraclegs/image/read_image.h"
#include "weights/checkpoint/torch_bytes.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
namespace torch = torch_bytes;

std::string BigEndian(uint64_t number, size_t width) {
  const std::string little = torch::Bytes(number, width);
  return {little.rbegin(), little.rend()};
}

/// A directory of so many tags, as many as it can have.
std::string Directory(size_t count, size_t next, unsigned tag) {
  return torch::Bytes(count, 2) +
         Repeated(count * 12,
                  [tag](size_t i) {
                    return torch::Bytes(tag + i % 2, 2) + torch::Bytes(4, 2) + torch::Bytes(1, 4) + torch::Bytes(8, 4);
                  }) +
         torch::Bytes(next, 4);
}

std::string ExifSegment(const std::string& tiff) {
  return "\xff\xe1" + BigEndian(tiff.size() + 8, 2) + std::string("Exif\0\0", 6) + tiff;
}

std::string Chunk(const std::string& type_and_body) {
  const auto crc = crc32_z(0, reinterpret_cast<const Bytef*>(type_and_body.data()), type_and_body.size());
  return BigEndian(type_and_body.size() - 4, 4) + type_and_body + BigEndian(crc, 4);
}

/// A PNG of noise with chunks behind its header.
std::string PngWith(int width, int height, const std::string& chunks) {
  constexpr size_t kPixelsAt = 33;  // behind signature and header
  Image8 image{width, height, 3, std::vector<uint8_t>(static_cast<size_t>(width) * static_cast<size_t>(height) * 3)};
  uint32_t state = 7;
  for (uint8_t& x : image.data) x = static_cast<uint8_t>((state = state * 1664525u + 1013904223u) >> 24);
  WritePng(BenchFolder() / "made.png", image);
  const std::string file = ReadFile(BenchFolder() / "made.png");
  return file.substr(0, kPixelsAt) + chunks + file.substr(kPixelsAt);
}

std::string HeifBoxOf(const std::string& type, const std::string& body) {
  return BigEndian(8 + body.size(), 4) + type + body;
}

}  // namespace

std::vector<ParserInput> PhotoInputs() {
  const auto photos = [](const std::string&) {
    const fs::path archive = BenchFolder() / "a.zip";
    if (IsZip(archive) && CountZipPhotos(archive) > 0) UnpackPhotos(archive, BenchFolder() / "photos", Silent());
  };
  const auto zip = [](size_t bytes, bool equal) {
    std::vector<std::pair<std::string, std::string>> files;
    const size_t n = std::min<size_t>(bytes / 110 + 1, 60000);
    for (size_t i = 0; i < n; ++i) files.emplace_back(Numbered("a", 100000 + i, ".jpg"), "");
    std::string archive = WriteZip(files);
    if (!equal) return archive;
    for (size_t at = archive.find("a1"); at != std::string::npos; at = archive.find("a1", at + 11)) {
      if (archive.compare(at + 7, 4, ".jpg") == 0) archive.replace(at, 11, "a100000.jpg");
    }
    return archive;
  };
  const auto info = [](const std::string&) { ReadImageInfo(BenchFolder() / "a.img"); };
  const auto exif = [](const std::string& file) { ParseExif(file); };
  const auto tags = [](const std::string& file) {
    ReadJpegMetadata(file);
    ReadExif(file);
  };
  const auto decode_png = [](const std::string& file) {
    ReadExif(file);
    DecodePng(file, "f");
  };
  return {
      {"photos in a zip", "of one name", [zip](size_t bytes) { return zip(bytes, true); }, photos, "a.zip"},
      {"photos in a zip", "of many names", [zip](size_t bytes) { return zip(bytes, false); }, photos, "a.zip"},
      {"exif", "many tags",
       [](size_t bytes) {
         const size_t n = std::min<size_t>(bytes / 12, 65535);
         return "II*" + std::string(1, '\0') + torch::Bytes(8, 4) + Directory(n, 8, 0x8769);
       },
       exif},
      {"exif", "many directories",
       [](size_t bytes) {
         const size_t each = 2 + 12 * 20 + 4;
         return "II*" + std::string(1, '\0') + torch::Bytes(8, 4) +
                Repeated(bytes, [each](size_t i) { return Directory(20, 8 + (i + 1) * each, 0x100); });
       },
       exif},
      {"gpano", "many names",
       [](size_t bytes) { return Repeated(bytes, [](size_t) { return std::string("GPano:ProjectionType=\""); }); },
       [](const std::string& file) { ReadProjection(file); }},
      {"jpeg", "many segments",
       [](size_t bytes) {
         return "\xff\xd8" + Repeated(bytes, [](size_t) { return std::string("\xff\xe1\0\2", 4); }) + "\xff\xd9";
       },
       tags},
      {"jpeg", "many tags",
       [](size_t bytes) {
         const std::string tiff = "II*" + std::string(1, '\0') + torch::Bytes(8, 4);
         return "\xff\xd8" + Repeated(bytes, [&](size_t) { return ExifSegment(tiff + Directory(5000, 8, 0x8769)); }) +
                "\xff\xd9";
       },
       tags},
      {"jpeg", "many segments, pixels",
       [](size_t bytes) {
         return "\xff\xd8" + Repeated(bytes, [](size_t) { return std::string("\xff\xfe\0\2", 4); }) +
                std::string("\xff\xc0\0\x0b\x08\0\x10\0\x10\1\1\x11\0\xff\xd9", 15);
       },
       [](const std::string& file) { DecodeJpeg(file, "f", Orientation::kUpright); }},
      {"jpeg", "many segments, size",
       [](size_t bytes) {
         return "\xff\xd8" + Repeated(bytes, [](size_t) { return std::string("\xff\xe1\0\2", 4); }) + "\xff\xd9";
       },
       info, "a.img"},
      {"png", "pixels",
       [](size_t bytes) {
         const int side = 1 + static_cast<int>(std::sqrt(static_cast<double>(bytes) / 3));
         return PngWith(side, side, "");
       },
       decode_png},
      {"png", "many chunks, size",
       [](size_t bytes) {
         return "\x89PNG\r\n\x1a\n" + Repeated(bytes, [](size_t) { return std::string("\0\0\0\0teXt\0\0\0\0", 12); });
       },
       info, "a.img"},
      {"png", "many texts",
       [](size_t bytes) {
         return PngWith(8, 8,
                        Repeated(bytes, [](size_t i) { return Chunk("tEXt" + Numbered("k", i, "") + '\0' + "v"); }));
       },
       decode_png},
      {"png", "one long text",
       [](size_t bytes) { return PngWith(8, 8, Chunk("tEXtk" + std::string(1, '\0') + std::string(bytes, 'v'))); },
       decode_png},
      {"webp", "many chunks",
       [](size_t bytes) {
         return "RIFF" + torch::Bytes(bytes, 4) + "WEBP" +
                Repeated(bytes, [](size_t) { return std::string("ABCD\0\0\0\0", 8); });
       },
       [info](const std::string& file) {
         ReadExif(file);
         info(file);
       },
       "a.img"},
      {"tiff", "many directories",
       [](size_t bytes) {
         const size_t each = 2 + 12 * 20 + 4;
         return "II*" + std::string(1, '\0') + torch::Bytes(8, 4) +
                Repeated(bytes, [each](size_t i) { return Directory(20, 8 + (i + 1) * each, 0x100); });
       },
       info, "a.img"},
      {"heif", "many references",
       [](size_t bytes) {
         const std::string zero(4, '\0');
         return HeifBoxOf("ftyp", "heic" + zero + "heic") +
                HeifBoxOf("meta", zero + HeifBoxOf("pitm", zero + BigEndian(1, 2)) +
                                      HeifBoxOf("iref", zero + Repeated(bytes, [](size_t i) {
                                                          return HeifBoxOf("dimg", BigEndian(1 + i % 60000, 2) +
                                                                                       BigEndian(1, 2) +
                                                                                       BigEndian(2 + i % 60000, 2));
                                                        })));
       },
       [info](const std::string& file) {
         ReadExif(file);
         info(file);
       },
       "a.img"},
      {"probe of a video", "many streams",
       [](size_t bytes) {
         return "{\"streams\":[" +
                Repeated(bytes, [](size_t i) { return (i == 0 ? "" : ",") + std::string("{\"nb_frames\":\"9\"}"); }) +
                "]}";
       },
       [](const std::string& file) { ParseProbe(file, "f"); }},
  };
}

}  // namespace oraclegs
