#include "oraclegs/web/file_below.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "oraclegs/core/text.h"

namespace oraclegs {
namespace {

constexpr size_t kMaxPath = 1024, kMaxName = 255;

/// A file descriptor of this scope.
class ScopedFd {
 public:
  explicit ScopedFd(int fd) : fd_(fd) {}
  ~ScopedFd() { Reset(-1); }
  ScopedFd(const ScopedFd&) = delete;
  ScopedFd& operator=(const ScopedFd&) = delete;
  int get() const { return fd_; }
  int Release() { return std::exchange(fd_, -1); }
  void Reset(int fd) {
    if (fd_ >= 0) close(fd_);
    fd_ = fd;
  }

 private:
  int fd_;
};

bool IsPlainName(std::string_view name) {
  return !name.empty() && name.size() <= kMaxName && name != "." && name != "..";
}

}  // namespace

bool IsPlainPath(std::string_view path) {
  if (path.empty() || path.size() > kMaxPath || !IsUtf8(std::string(path))) return false;
  const bool odd = std::any_of(path.begin(), path.end(),
                               [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f || c == '\\'; });
  if (odd) return false;
  for (size_t begin = 0; begin <= path.size();) {
    const size_t end = std::min(path.find('/', begin), path.size());
    if (!IsPlainName(path.substr(begin, end - begin))) return false;
    begin = end + 1;
  }
  return true;
}

std::optional<FileBelow> FileBelow::Open(const std::filesystem::path& root, std::string_view path) {
  if (!IsPlainPath(path)) return std::nullopt;
  ScopedFd at(open(root.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  // One name at a time: no link is followed, whoever puts one there meanwhile.
  while (at.get() >= 0) {
    const size_t slash = path.find('/');
    const std::string name(path.substr(0, slash));
    if (slash == std::string_view::npos) {
      at.Reset(openat(at.get(), name.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
      break;
    }
    at.Reset(openat(at.get(), name.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
    path.remove_prefix(slash + 1);
  }
  struct stat info {};
  if (at.get() < 0 || fstat(at.get(), &info) != 0 || !S_ISREG(info.st_mode)) return std::nullopt;
  std::string tag = fmt::format("{:x}-{:x}-{:x}-{:x}", info.st_ino, info.st_size, info.st_mtim.tv_sec,
                                info.st_mtim.tv_nsec);  // a sum would not hold every time that a file can have
  return FileBelow(at.Release(), static_cast<uint64_t>(info.st_size), std::move(tag));
}

FileBelow::~FileBelow() {
  if (fd_ >= 0) close(fd_);
}

std::optional<size_t> FileBelow::ReadAt(uint64_t offset, char* to, size_t count) const {
  size_t done = 0;
  while (done < count) {
    const ssize_t n = pread(fd_, to + done, count - done, static_cast<off_t>(offset + done));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return std::nullopt;
    if (n == 0) break;
    done += static_cast<size_t>(n);
  }
  return done;
}

std::optional<std::string> FileBelow::ReadAll(uint64_t max_bytes) const {
  if (size_ > max_bytes) return std::nullopt;
  std::string bytes(size_, '\0');
  if (ReadAt(0, bytes.data(), bytes.size()) != bytes.size()) return std::nullopt;
  return bytes;
}

}  // namespace oraclegs
