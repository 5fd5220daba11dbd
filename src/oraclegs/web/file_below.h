#pragma once
// Files of a folder that others write to, opened so that nothing outside it is ever read.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace oraclegs {

/// Whether a path is like "a/b.png": names in UTF-8 between single slashes, none of them ".", ".." or longer than 255
/// bytes, without backslashes, control characters or a slash at the ends, together at most 1024 bytes.
bool IsPlainPath(std::string_view path);

/// An open regular file.
class FileBelow {
 public:
  /// Opens `path` below `root`; `root` itself may be a link, no part of `path` may be one. nullopt for a path that is
  /// not plain, a missing file, a link, a folder, a pipe or a device.
  static std::optional<FileBelow> Open(const std::filesystem::path& root, std::string_view path);

  FileBelow(FileBelow&& other) noexcept
      : fd_(std::exchange(other.fd_, -1)), size_(other.size_), tag_(std::move(other.tag_)) {}
  FileBelow& operator=(FileBelow&& other) noexcept {
    std::swap(fd_, other.fd_);
    size_ = other.size_;
    tag_ = std::move(other.tag_);
    return *this;
  }
  ~FileBelow();

  /// Size in bytes at the time of opening.
  uint64_t size() const { return size_; }
  /// Text that changes with the content: file, size and time of change.
  const std::string& tag() const { return tag_; }
  /// Reads at an offset. Returns the number of bytes, below `count` only at the end of the file; nullopt on an error.
  std::optional<size_t> ReadAt(uint64_t offset, char* to, size_t count) const;
  /// Reads the whole file; nullopt when it is larger than `max_bytes`, on an error, or when it became shorter.
  std::optional<std::string> ReadAll(uint64_t max_bytes) const;

 private:
  FileBelow(int fd, uint64_t size, std::string tag) : fd_(fd), size_(size), tag_(std::move(tag)) {}

  int fd_ = -1;
  uint64_t size_ = 0;
  std::string tag_;
};

}  // namespace oraclegs
