#include "oraclegs/formats/spz_container.h"

#include <zstd.h>
#include <zstd_errors.h>

#include <memory>
#include <vector>

#include "oraclegs/core/error.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/formats/gzip.h"
#include "oraclegs/formats/values.h"

namespace oraclegs {
namespace {

constexpr uint32_t kOldestSpz = 1, kNewestSpz = 4;
constexpr size_t kSpz4Header = 32, kSpz4TableRow = 16;
constexpr int kHighestSpzDegree = 4;
constexpr int kSpzAntialiased = 1, kSpzExtended = 2;  // flags
constexpr int kZstdLevel =
    17;  // as slow as gzip at its best, and 3 % smaller; level 12 is 5 times as fast and no smaller

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

/// Where the attributes end that are streams of version 4; without harmonics there is none of them.
std::vector<uint64_t> StreamEnds(const SpzContent& content) {
  const SpzLayout at(content.count, content.degree, content.version);
  std::vector<uint64_t> ends = {at.alphas, at.colors, at.scales, at.rotations, at.sh};
  if (at.end > at.sh) ends.push_back(at.end);
  return ends;
}

/// The header behind its numbers, the table and the streams.
std::string PackStreams(const SpzContent& content) {
  const std::vector<uint64_t> ends = StreamEnds(content);
  std::string bytes(kSpz4Header - kSpzHeader + ends.size() * kSpz4TableRow, '\0');
  StoreLittle(bytes.data(), static_cast<uint32_t>(kSpz4Header));
  char* row = bytes.data() + kSpz4Header - kSpzHeader;
  std::vector<std::string> streams(ends.size());
  ParallelFor(static_cast<int64_t>(ends.size()), [&](int64_t s) {
    const uint64_t from = s == 0 ? 0 : ends[s - 1], length = ends[s] - from;
    streams[s].resize(ZSTD_compressBound(length));
    const size_t packed =
        ZSTD_compress(streams[s].data(), streams[s].size(), content.attributes.data() + from, length, kZstdLevel);
    if (ZSTD_isError(packed) != 0) throw RunError("zstd: cannot pack the splat: {}", ZSTD_getErrorName(packed));
    streams[s].resize(packed);
    StoreLittle(row + s * kSpz4TableRow, uint64_t{packed});
    StoreLittle(row + s * kSpz4TableRow + 8, length);
  });
  for (const std::string& stream : streams) bytes += stream;
  return bytes;
}

/// The attributes of version 4, one after the other.
std::string UnpackStreams(std::string_view bytes, const SpzContent& content, const std::string& file) {
  const std::vector<uint64_t> ends = StreamEnds(content);
  const uint64_t table = LoadLittle<uint32_t>(bytes, 16), streams = static_cast<uint8_t>(bytes[15]);
  if (streams != ends.size() || table < kSpz4Header || table > bytes.size() ||
      bytes.size() - table < streams * kSpz4TableRow) {
    throw InputError("{}: its table of {} streams at byte {} is damaged; copy or export it again", file, streams,
                     table);
  }
  std::string attributes(ends.back(), '\0');
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

std::string PackSpz(const SpzContent& content) {
  std::string header(kSpzHeader, '\0');
  StoreLittle(header.data(), kSpzMagic);
  StoreLittle(header.data() + 4, content.version);
  StoreLittle(header.data() + 8, content.count);
  header[12] = static_cast<char>(content.degree);
  header[13] = static_cast<char>(content.fractional_bits);
  header[14] = static_cast<char>(content.antialiased ? kSpzAntialiased : 0);
  if (content.version < kNewestSpz) return Gzip(header + content.attributes);
  header[15] = static_cast<char>(StreamEnds(content).size());
  return header + PackStreams(content);
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
