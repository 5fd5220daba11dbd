// The checkpoint of a training: a safetensors file whose checksum is put right.

#include <zlib.h>

#include <cstdio>

#include "fuzz/fuzz.h"
#include "oraclegs/train/checkpoint.h"

namespace {

/// The bytes with the right CRC-32 in the file's metadata, if it has one.
std::string WithTrainChecksum(std::string file) {
  constexpr std::string_view kMark = "crc32=";
  const size_t at = file.find(kMark);
  if (at == std::string::npos || at + kMark.size() + 8 > file.size()) return file;
  file.replace(at + kMark.size(), 8, 8, '0');
  const auto crc = crc32_z(0, reinterpret_cast<const Bytef*>(file.data()), file.size());
  char digits[9];
  std::snprintf(digits, sizeof digits, "%08lx", crc);
  return file.replace(at + kMark.size(), 8, digits);
}

}  // namespace

ORACLEGS_FUZZ_TARGET(train_checkpoint) {
  using namespace oraclegs;
  static const fuzz::Folder folder;
  std::string file(bytes);
  if (bytes.starts_with('{')) {
    const auto parts = fuzz::Parts(bytes);
    file = fuzz::Little(parts[0].size(), 8) + std::string(parts[0]) + std::string(fuzz::PartAt(parts, 1));
  }
  const auto path = folder.Put("iteration_0000001.safetensors", WithTrainChecksum(std::move(file)));
  fuzz::Try([&] { ReadCheckpoint(path); });
}
