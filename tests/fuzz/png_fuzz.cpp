// PNG: a file whose checksums are put right, or a header of 13 bytes and rows, which are packed.

#include <zlib.h>

#include "fuzz/fuzz.h"
#include "fuzz/images.h"
#include "oraclegs/image/codecs.h"

namespace {

constexpr std::string_view kPngSignature("\x89PNG\r\n\x1a\n", 8);

std::string PngChunk(std::string_view type_and_body) {
  const auto crc = crc32_z(0, reinterpret_cast<const Bytef*>(type_and_body.data()), type_and_body.size());
  return oraclegs::fuzz::Big(type_and_body.size() - 4, 4) + std::string(type_and_body) + oraclegs::fuzz::Big(crc, 4);
}

/// The complete chunks, with right checksums.
std::string WithPngChecksums(std::string_view file) {
  std::string fixed(file.substr(0, kPngSignature.size()));
  file.remove_prefix(fixed.size());
  while (file.size() >= 12) {
    uint64_t length = 0;
    for (size_t i = 0; i < 4; ++i) length = length << 8 | static_cast<unsigned char>(file[i]);
    if (length > file.size() - 12) break;
    fixed += PngChunk(file.substr(4, length + 4));
    file.remove_prefix(length + 12);
  }
  return fixed + std::string(file);
}

std::string PngOf(std::string_view header_and_rows) {
  const std::string_view header = header_and_rows.substr(0, 13), rows = header_and_rows.substr(header.size());
  std::string packed(compressBound(rows.size()), '\0');
  uLongf size = packed.size();
  compress2(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(rows.data()), rows.size(),
            0);
  packed.resize(size);
  return std::string(kPngSignature) + PngChunk("IHDR" + std::string(header)) +
         PngChunk("PLTE" + std::string(30, '\x55')) + PngChunk("IDAT" + packed) + PngChunk("IEND");
}

}  // namespace

ORACLEGS_FUZZ_TARGET(png) {
  using namespace oraclegs;
  const std::string file = IsPng(bytes) ? WithPngChecksums(bytes) : PngOf(bytes);
  if (!fuzz::IsSmall([&](int* width, int* height) { ReadPngSize(file, "f", width, height); })) return;
  fuzz::Try([&] { DecodePng(file, "f"); });
  static const fuzz::Folder folder;
  const auto path = folder.Put("a.png", file);
  fuzz::Try([&] { ReadPng16(path); });
}
