#include "oraclegs/formats/spz_container.h"

#include <zstd.h>
#include <zstd_errors.h>

#include <memory>
#include <vector>

#include "oraclegs/core/error.h"
#include "oraclegs/formats/gzip.h"
#include "oraclegs/formats/values.h"

namespace oraclegs {
namespace {

constexpr uint32_t kOldestSpz = 1, kNewestSpz = 4;
constexpr size_t kSpz4Header = 32, kSpz4TableRow = 16;
constexpr int kHighestSpzDegree = 4;
constexpr int kSpzExtended = 2;  // a flag

// Packers shrink equal bytes a thousandfold, but the positions of a scene are mostly noise.
constexpr uint64_t kSpzPlausibleBytes = 4 << 20, kSpzMostPerByte = 200;

bool HasMagic(std::string_view bytes) { return bytes.size() >= 8 && LoadLittle<uint32_t>(bytes, 0) == kSpzMagic; }

/// Numbers that the headers of all versions begin with; the rest of the numbers is compared with `packed` bytes of the
/// file.
SpzContent ParseSpzHeader(std::string_view header, size_t packed, const std::string& file) {
  if (header.size() < kSpzHeader || !HasMagic(header)) {
    throw InputError("{}: is not a splat in SPZ format; export it again", file);
  }
  SpzContent content;
  content.version = LoadLittle<uint32_t>(header, 4);
  if (content.version < kOldestSpz || content.version > kNewestSpz) {
    throw InputError("{}: is SPZ of version {}, and the versions {} to {} can be read; export it as one of them", file,
                     content.version, kOldestSpz, kNewestSpz);
  }
  content.count = LoadLittle<uint32_t>(header, 8);
  content.degree = static_cast<uint8_t>(header[12]);
  content.fractional_bits = static_cast<uint8_t>(header[13]);
  const int flags = static_cast<uint8_t>(header[14]);
  content.antialiased = (flags & kSpzAntialiased) != 0;
  content.extended = (flags & kSpzExtended) != 0;
  if (content.degree > kHighestSpzDegree || content.fractional_bits > kMaxFractionalBits) {
    throw InputError("{}: has harmonics of degree {} and {} fractional bits, expected at most {} and {}", file,
                     content.degree, content.fractional_bits, kHighestSpzDegree, kMaxFractionalBits);
  }
  if (content.count == 0) throw InputError("{}: holds no Gaussians; export it again", file);
  const uint64_t bytes = SpzLayout(content.count, content.degree, content.version).end;
  if (bytes > kSpzPlausibleBytes && bytes / kSpzMostPerByte > packed) {
    throw InputError("{}: promises {} Gaussians in {} bytes; the file is damaged", file, content.count, packed);
  }
  return content;
}

/// The attributes of version 4, one after the other.
std::string UnpackStreams(std::string_view bytes, const SpzContent& content, const std::string& file) {
  const SpzLayout at(content.count, content.degree, content.version);
  std::vector<uint64_t> ends = {at.alphas, at.colors, at.scales, at.rotations, at.sh};
  if (at.end > at.sh) ends.push_back(at.end);
  const uint64_t table = LoadLittle<uint32_t>(bytes, 16), streams = static_cast<uint8_t>(bytes[15]);
  if (streams != ends.size() || table < kSpz4Header || table > bytes.size() ||
      bytes.size() - table < streams * kSpz4TableRow) {
    throw InputError("{}: its table of {} streams at byte {} is damaged; copy or export it again", file, streams,
                     table);
  }
  std::string attributes(at.end, '\0');
  uint64_t from = table + streams * kSpz4TableRow, to = 0;
  for (size_t s = 0; s < ends.size(); ++s) {
    const auto packed = LoadLittle<uint64_t>(bytes, table + s * kSpz4TableRow);
    if (packed > bytes.size() - from) {
      throw InputError("{}: ends within its stream {}; copy it again", file, s);
    }
    const size_t got = ZSTD_decompress(attributes.data() + to, ends[s] - to, bytes.data() + from, packed);
    if (ZSTD_isError(got) != 0 && ZSTD_getErrorCode(got) == ZSTD_error_memory_allocation) {
      throw OutOfMemory("{}: no memory to unpack it", file);
    }
    if (ZSTD_isError(got) != 0 || got != ends[s] - to) {
      throw InputError("{}: its stream {} is damaged, or not of {} Gaussians; copy or export it again", file, s,
                       content.count);
    }
    from += packed;
    to = ends[s];
  }
  return attributes;
}

}  // namespace

SpzLayout::SpzLayout(uint64_t n, int degree, uint32_t version)
    : position_bytes(version == 1 ? 6 : 9),
      rotation_bytes(version <= 2 ? 3 : 4),
      sh_bytes(3 * (static_cast<uint64_t>(ShCount(degree)) - 1)) {
  alphas = n * position_bytes;
  colors = alphas + n;
  scales = colors + 3 * n;
  rotations = scales + 3 * n;
  sh = rotations + rotation_bytes * n;
  end = sh + sh_bytes * n;
}

SpzContent UnpackSpz(std::string_view bytes, const std::string& file) {
  if (HasMagic(bytes) && LoadLittle<uint32_t>(bytes, 4) >= kNewestSpz) {
    SpzContent content = ParseSpzHeader(bytes, bytes.size(), file);
    if (bytes.size() < kSpz4Header) throw InputError("{}: ends within its header; copy it again", file);
    content.attributes = UnpackStreams(bytes, content, file);
    return content;
  }
  const bool bare = HasMagic(bytes);  // nothing is packed
  std::unique_ptr<Gunzip> gzip = bare ? nullptr : std::make_unique<Gunzip>(bytes, file);
  SpzContent content = ParseSpzHeader(bare ? bytes.substr(0, kSpzHeader) : gzip->Next(kSpzHeader), bytes.size(), file);
  const uint64_t wanted = SpzLayout(content.count, content.degree, content.version).end;
  content.attributes = bare ? std::string(bytes.substr(kSpzHeader, wanted)) : gzip->Next(wanted);
  if (content.attributes.size() != wanted) {
    throw InputError("{}: promises {} Gaussians, which need {} bytes, but holds {}; copy or export it again", file,
                     content.count, kSpzHeader + wanted, kSpzHeader + content.attributes.size());
  }
  return content;
}

}  // namespace oraclegs
