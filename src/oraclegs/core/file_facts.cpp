#include "oraclegs/core/file_facts.h"

#include <sys/stat.h>
#include <zlib.h>

#include <ctime>

#include "oraclegs/core/files.h"
#include "oraclegs/core/sha256.h"

namespace oraclegs {
namespace {

constexpr int64_t kNanoseconds = 1'000'000'000;
constexpr int64_t kUnsure = 2 * kNanoseconds;

int64_t In(const timespec& time) { return int64_t{time.tv_sec} * kNanoseconds + time.tv_nsec; }

}  // namespace

std::optional<FileState> StateOf(const std::filesystem::path& path) {
  struct stat info = {};
  timespec now = {};
  if (stat(path.c_str(), &info) != 0 || !S_ISREG(info.st_mode) || clock_gettime(CLOCK_REALTIME, &now) != 0) return {};
  const int64_t content = In(info.st_mtim), status = In(info.st_ctim);
  if (In(now) - status < kUnsure || In(now) - content < kUnsure) return {};
  return FileState{static_cast<int64_t>(info.st_dev), static_cast<int64_t>(info.st_ino), int64_t{info.st_size}, content,
                   status};
}

FileDigest DigestOf(const std::filesystem::path& path) {
  static FileFacts<FileDigest> digests;
  return digests.Of(path, [&] {
    const std::string bytes = ReadFile(path);
    char length[8];
    for (uint64_t rest = bytes.size(), i = 0; i < 8; ++i, rest >>= 8) length[i] = static_cast<char>(rest & 0xff);
    return FileDigest{bytes.size(),
                      static_cast<uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size())),
                      Sha256().Add(bytes).Add({length, sizeof(length)}).Hex()};
  });
}

}  // namespace oraclegs
